# embed_texts(LIBRARY HEADER NAMESPACE NAME=FILE...): texts in the program, each as a function that
# HEADER declares; adds their source to LIBRARY, and is the script that writes it when built.
if(CMAKE_SCRIPT_MODE_FILE)
  set(source "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n")
  foreach(text ${TEXTS})
    string(REPLACE "=" ";" text "${text}")
    list(GET text 0 name)
    list(GET text 1 path)
    file(READ "${path}" content)
    string(APPEND source "\nstd::string_view ${name}() { return R\"text(${content})text\"; }\n")
  endforeach()
  file(WRITE ${OUTPUT} "${source}\n}  // namespace ${NAMESPACE}\n")
  return()
endif()

set(EMBED_TEXTS ${CMAKE_CURRENT_LIST_FILE})
function(embed_texts library header namespace)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${library}_texts.cpp)
  list(TRANSFORM ARGN REPLACE "^[^=]*=" "" OUTPUT_VARIABLE files)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} "-DTEXTS=${ARGN}" -DHEADER=${header} -DNAMESPACE=${namespace}
            -DOUTPUT=${output} -P ${EMBED_TEXTS}
    DEPENDS ${files} ${EMBED_TEXTS}
    VERBATIM)
  target_sources(${library} PRIVATE ${output})
endfunction()
