#include "server/http/media_types.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.hpp"

namespace unwrapd::server::http {
namespace {

TEST(MediaTypes, AcceptChoosesAndTheJobSaysTheRest) {
  EXPECT_EQ(choose_format("", "obj"), "obj");
  EXPECT_EQ(choose_format("*/*", "gltf"), "gltf");
  EXPECT_EQ(choose_format("model/*", "obj"), "obj");
  EXPECT_EQ(choose_format("model/gltf-binary", "obj"), "glb");
  EXPECT_EQ(choose_format("application/json", "glb"), "json");
  EXPECT_EQ(choose_format("text/html, MODEL/OBJ;q=0.5, model/gltf+json;q=0.9", "glb"), "gltf");
  EXPECT_EQ(choose_format("*/*;q=0.1, application/json", "glb"), "json");
  EXPECT_EQ(choose_format("model/gltf-binary;q=0, */*", "glb"), "gltf");
}

TEST(MediaTypes, WhatCannotBeHadIsRefused) {
  for (const char* accept : {"text/html", "model/gltf-binary;q=0", "image/*", ",", "garbage"})
    EXPECT_THROW(choose_format(accept, "glb"), Error) << accept;
}

TEST(MediaTypes, BodiesAreAssetsOrForms) {
  EXPECT_EQ(body_kind("model/obj"), BodyKind::asset);
  EXPECT_EQ(body_kind("model/stl"), BodyKind::asset);
  EXPECT_EQ(body_kind("Model/PLY"), BodyKind::asset);
  EXPECT_EQ(body_kind("application/zip"), BodyKind::asset);
  EXPECT_EQ(body_kind("model/off; charset=utf-8"), BodyKind::asset);
  EXPECT_EQ(body_kind(""), BodyKind::asset);
  EXPECT_EQ(body_kind("Multipart/Form-Data; boundary=x"), BodyKind::multipart);
  EXPECT_THROW(body_kind("text/html"), Error);
  EXPECT_THROW(body_kind("application/x-www-form-urlencoded"), Error);
}

TEST(MediaTypes, ABoundaryIsFoundHoweverItIsWritten) {
  for (const char* form :
       {"multipart/form-data; boundary=q", "Multipart/Form-Data;Boundary=\"q\"",
        "multipart/form-data; boundary=q; charset=utf-8", "multipart/form-data;; x; BOUNDARY = q"})
    EXPECT_EQ(multipart_boundary(form), "q") << form;
  for (const char* none : {"", ";", "multipart/form-data", "multipart/form-data; boundary",
                           "text/plain; boundary=q", "multipart/form-data; boundary="})
    EXPECT_EQ(multipart_boundary(none), "") << none;
}

TEST(MediaTypes, EventsAreForWhoNamesThem) {
  for (const char* events : {"text/event-stream", "Text/Event-Stream; charset=utf-8", "text/*",
                             "text/event-stream, */*", "application/json;q=0.5, text/event-stream"})
    EXPECT_TRUE(prefers_events(events)) << events;
  for (const char* json :
       {"", "*/*", "application/json", "application/json, text/event-stream", "text/html",
        "text/event-stream;q=0", "text/event-stream;q=0.5, application/json", "garbage"})
    EXPECT_FALSE(prefers_events(json)) << json;
}

TEST(MediaTypes, ReadsThePreferredWait) {
  EXPECT_EQ(preferred_wait("wait=10"), 10);
  EXPECT_EQ(preferred_wait("wait = \"10\""), 10);
  EXPECT_EQ(preferred_wait("respond-async, wait=10; foo=1"), 10);
  EXPECT_EQ(preferred_wait("respond-async, Wait=3"), 3);
  EXPECT_EQ(preferred_wait("wait=99999999999"), std::numeric_limits<int>::max());
  for (const char* none : {"", "wait", "wait=", "wait=\"", "waits=1", "foo; wait=1", "wait=x",
                           "wait=-1", "wait=1.5", "return=minimal"})
    EXPECT_FALSE(preferred_wait(none)) << none;
}

TEST(MediaTypes, ReadsOneRange) {
  const auto is = [](const char* text, std::int64_t offset, std::int64_t length) {
    const auto range = single_range(text, 100);
    return range && range->offset == offset && range->length == length;
  };
  EXPECT_TRUE(is("bytes=0-0", 0, 1));
  EXPECT_TRUE(is("bytes=10-19", 10, 10));
  EXPECT_TRUE(is("bytes=90-", 90, 10));
  EXPECT_TRUE(is("bytes=90-500", 90, 10));
  EXPECT_TRUE(is("bytes=-7", 93, 7));
  EXPECT_TRUE(is("bytes=-500", 0, 100));
  for (const char* none : {"", "bytes=", "bytes=-", "bytes=100-", "bytes=5-4", "bytes=0-1,4-5",
                           "items=0-1", "bytes=a-b", "bytes=-0", "bytes=1-x"})
    EXPECT_FALSE(single_range(none, 100)) << none;
}

}  // namespace
}  // namespace unwrapd::server::http
