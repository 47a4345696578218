# Writes the C++ source that holds openapi.yaml: cmake -DYAML=... -DOUTPUT=... -P this file.
file(READ ${YAML} text)
file(WRITE ${OUTPUT} "#include \"api/openapi.hpp\"

namespace unwrapd::api {

std::string_view openapi_yaml() { return R\"yaml(${text})yaml\"; }

}  // namespace unwrapd::api
")
