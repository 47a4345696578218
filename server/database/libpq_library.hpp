#pragma once
// libpq, loaded when the first PostgreSQL database is opened. Linked, it would bring Kerberos and
// LDAP into every worker process, and into servers that use SQLite.

#include <postgresql/libpq-fe.h>

namespace unwrapd::server::database {

/// The functions of libpq that are used here, by their names without "PQ".
class LibpqLibrary {
 public:
  /// Loads it once. Throws InsideError{internal} when it is not installed.
  static const LibpqLibrary& loaded();

  decltype(&::PQconnectdbParams) connect;
  decltype(&::PQconninfoParse) parse;
  decltype(&::PQconninfoFree) free_parsed;
  decltype(&::PQfreemem) free_text;
  decltype(&::PQfinish) finish;
  decltype(&::PQstatus) status;
  decltype(&::PQerrorMessage) error_message;
  decltype(&::PQparameterStatus) parameter_status;
  decltype(&::PQserverVersion) server_version;
  decltype(&::PQexec) exec;
  decltype(&::PQprepare) prepare;
  decltype(&::PQexecPrepared) exec_prepared;
  decltype(&::PQresultStatus) result_status;
  decltype(&::PQresultErrorField) result_error_field;
  decltype(&::PQcmdTuples) cmd_tuples;
  decltype(&::PQntuples) row_count;
  decltype(&::PQgetvalue) value;
  decltype(&::PQgetlength) length;
  decltype(&::PQclear) clear;
  decltype(&::PQsocket) socket;
  decltype(&::PQconsumeInput) consume_input;
  decltype(&::PQnotifies) notifies;

 private:
  LibpqLibrary();
};

}  // namespace unwrapd::server::database
