#pragma once
// Work on meshes yields to answers, which take microseconds and should not wait for a turn of
// milliseconds.

namespace unwrapd::server {

/// Of this thread, and of all threads and processes that it starts: it cannot be taken back.
void give_way();

}  // namespace unwrapd::server
