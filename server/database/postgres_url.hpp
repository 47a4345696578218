#pragma once
// libpq quotes what it cannot read of a URL, which may be a piece of a password. So nothing is
// handed on to it in which a password could be taken for something else.

#include <string>

namespace unwrapd::server::database {

/// Throws InsideError{storage_failed}, which quotes nothing of it, when libpq cannot read it or a
/// sign in it that is not written as %.. makes it doubtful where the password ends.
void check_url(const std::string& url);

/// The failure of a connection, without what it quotes where no server was tried yet.
std::string without_pieces_of_url(std::string message);

}  // namespace unwrapd::server::database
