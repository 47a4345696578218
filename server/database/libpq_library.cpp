#include "server/database/libpq_library.hpp"

#include "server/base/loaded_library.hpp"

namespace unwrapd::server::database {

LibpqLibrary::LibpqLibrary() {
  const LoadedLibrary library("libpq.so.5", "libpq5", "The server's database cannot be used.");
  library.find(connect, "PQconnectdbParams");
  library.find(parse, "PQconninfoParse");
  library.find(free_parsed, "PQconninfoFree");
  library.find(free_text, "PQfreemem");
  library.find(finish, "PQfinish");
  library.find(status, "PQstatus");
  library.find(error_message, "PQerrorMessage");
  library.find(parameter_status, "PQparameterStatus");
  library.find(server_version, "PQserverVersion");
  library.find(exec, "PQexec");
  library.find(prepare, "PQprepare");
  library.find(exec_prepared, "PQexecPrepared");
  library.find(result_status, "PQresultStatus");
  library.find(result_error_field, "PQresultErrorField");
  library.find(cmd_tuples, "PQcmdTuples");
  library.find(row_count, "PQntuples");
  library.find(value, "PQgetvalue");
  library.find(length, "PQgetlength");
  library.find(clear, "PQclear");
  library.find(socket, "PQsocket");
  library.find(consume_input, "PQconsumeInput");
  library.find(notifies, "PQnotifies");
}

const LibpqLibrary& LibpqLibrary::loaded() {
  static const LibpqLibrary library;
  return library;
}

}  // namespace unwrapd::server::database
