#include "io/readback_origin.h"

#include "absl/strings/str_cat.h"
#include "wire/utf8.h"

namespace lightfit {

std::string OriginText(const ReadbackOrigin& origin) {
  std::string text;
  const auto add = [&text](const char* words, const std::string& name) {
    if (!name.empty()) absl::StrAppend(&text, words, "\"", Utf8Text(name), "\"");
  };
  add("depth ", origin.depth_channel);
  add(" of part ", origin.depth_part);
  add(", camera of part ", origin.camera_part);
  add(", view ", origin.view);
  return text;
}

v1::ReadbackOrigin OriginToProto(const ReadbackOrigin& origin) {
  v1::ReadbackOrigin proto;
  proto.set_depth_channel(Utf8Text(origin.depth_channel));
  proto.set_depth_part(Utf8Text(origin.depth_part));
  proto.set_view(Utf8Text(origin.view));
  proto.set_camera_part(Utf8Text(origin.camera_part));
  return proto;
}

}  // namespace lightfit
