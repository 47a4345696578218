// Writes api/openapi.yaml as JSON at build time, with its examples in place of their files:
//   contract_maker DIR_OF_API OPENAPI_JSON
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "api/contract/yaml_json.hpp"

namespace {

std::string read(const std::string& path) {
  const std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw std::runtime_error(path + " cannot be read");
  return text.str();
}

using unwrapd::contract::Json;

/// Every example has its value in place of the file that holds it: JSON, or text.
void take_in_examples(const std::string& folder, Json& part) {
  if (const auto file = part.is_object() ? part.find("externalValue") : part.end();
      file != part.end()) {
    const auto name = file->get<std::string>();
    const std::string text = read(folder + "/" + name);
    part.erase("externalValue");
    part["value"] = name.ends_with(".json") ? Json::parse(text) : Json(text);
    return;
  }
  if (part.is_structured())
    for (Json& inner : part) take_in_examples(folder, inner);
}

void write(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error(path + " cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: contract_maker DIR_OF_API OPENAPI_JSON\n";
    return 2;
  }
  const std::string api = argv[1];
  try {
    Json contract = unwrapd::contract::json_of_yaml(read(api + "/openapi.yaml"));
    take_in_examples(api, contract);
    write(argv[2], contract.dump() + "\n");
    return 0;
  } catch (const std::exception& error) {
    std::cerr << api << "/openapi.yaml: " << error.what() << "\n";
    return 1;
  }
}
