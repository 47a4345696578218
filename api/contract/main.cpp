// Made at build time of api/openapi.yaml: the same as JSON, and the page for people.
//   contract DIR_OF_API OPENAPI_JSON DOCS_HTML
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "api/contract/page.hpp"
#include "api/contract/yaml_json.hpp"

namespace {

std::string read(const std::string& path) {
  const std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw std::runtime_error(path + " cannot be read");
  return text.str();
}

void write(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error(path + " cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: contract DIR_OF_API OPENAPI_JSON DOCS_HTML\n";
    return 2;
  }
  const std::string api = argv[1];
  try {
    const unwrapd::contract::Json contract =
        unwrapd::contract::json_of_yaml(read(api + "/openapi.yaml"));
    const auto example = [&](const std::string& file) { return read(api + "/" + file); };
    write(argv[2], contract.dump() + "\n");
    write(argv[3], unwrapd::contract::page_of(contract, example));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << api << "/openapi.yaml: " << error.what() << "\n";
    return 1;
  }
}
