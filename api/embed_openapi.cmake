# Writes the C++ source that holds texts, each as a function: cmake -DTEXTS=name=file;... -DOUTPUT=...
# -P this file.
set(source "#include \"api/openapi.hpp\"\n\nnamespace unwrapd::api {\n")
foreach(text ${TEXTS})
  string(REPLACE "=" ";" text "${text}")
  list(GET text 0 name)
  list(GET text 1 path)
  file(READ "${path}" content)
  string(APPEND source "\nstd::string_view ${name}() { return R\"text(${content})text\"; }\n")
endforeach()
file(WRITE ${OUTPUT} "${source}\n}  // namespace unwrapd::api\n")
