// scenes/gltf/document.h
//
// A glTF 2.0 file and the bytes that it refers to.
// In:   the path of a .gltf or .glb file.
// Out:  its JSON; the bytes of its buffer views, decompressed.
//
// What a file asks for is bounded by its size: see Take(). Of the libraries at hand TinyGLTF 2.7
// refuses compressed files for their empty fallback buffer and overruns its stack where JSON is
// nested deeply, and assimp 5.2 knows no compression but Draco's and leaves extensions out in
// silence.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "scenes/gltf/json.h"

namespace lightfit::gltf {

// Bytes that live as long as the document.
struct View {
  absl::string_view bytes;
  int64_t stride = 0;  // from one element to the next; 0: none is stated
};

class Document {
 public:
  // Errors are without the file's name. InvalidArgument names an extension that is required and not
  // known here.
  static absl::StatusOr<Document> Read(const std::string& path);

  const Json& json() const { return json_; }

  // The element of a list of the file, such as "nodes"; InvalidArgument when there is none.
  absl::StatusOr<const Json*> Element(const char* list, int64_t index) const;

  // Buffers are read when they are first asked for.
  absl::StatusOr<View> BufferView(int64_t index);

  // Counts numbers that are read, or triangles and vertices that are shown, against what a file of
  // this size may ask for. InvalidArgument beyond it.
  absl::Status Take(int64_t numbers, int64_t shown);

 private:
  struct Buffer {
    bool is_read = false;
    std::string owned;
    absl::string_view bytes;
  };
  struct Unpacked {
    bool is_read = false;
    std::string bytes;
  };

  Document() = default;
  absl::Status ReadGlb();
  absl::Status ParseJson(absl::string_view text);
  absl::Status CheckExtensions() const;
  absl::StatusOr<absl::string_view> BufferBytes(int64_t index);
  absl::StatusOr<absl::string_view> Part(const Json& from, absl::string_view where);
  absl::StatusOr<View> Unpack(int64_t index, const Json& compression);

  std::string folder_;
  std::string file_;  // GLB: keeps the chunk
  Json json_;
  absl::string_view chunk_;  // the binary one of a GLB file
  bool has_chunk_ = false;
  std::vector<Buffer> buffers_;
  std::vector<Unpacked> unpacked_;  // by buffer view
  int64_t num_bytes_ = 0;           // of everything that was read
  int64_t numbers_ = 0, shown_ = 0;
};

}  // namespace lightfit::gltf
