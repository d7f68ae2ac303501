#include "wire/frame_identity.h"

#include <zlib.h>

#include <algorithm>
#include <boost/uuid/name_generator.hpp>
#include <boost/uuid/uuid.hpp>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "wire/camera_proto.h"

namespace lightfit {
namespace {

// Of what goes into a hash: SHA-1 at the end, which a large image is first made small for.
class Content {
 public:
  void AddImage(absl::Span<const float> values, int width) {
    const auto row_bytes = static_cast<size_t>(width) * sizeof(float);
    for (size_t begin = 0; begin < values.size(); begin += static_cast<size_t>(width)) {
      const size_t left = (values.size() - begin) * sizeof(float);
      AddNumber(crc32(0,
                      reinterpret_cast<const Bytef*>(values.data() + begin),
                      static_cast<uInt>(std::min(row_bytes, left))));
    }
  }

  void AddNumber(uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(static_cast<char>(value >> shift));
  }

  void AddText(absl::string_view text) {
    AddNumber(text.size());
    absl::StrAppend(&bytes_, text);
  }

  std::array<uint8_t, 16> Hash() const {
    // Any fixed name space does.
    const boost::uuids::name_generator_sha1 generator(boost::uuids::ns::oid());
    const boost::uuids::uuid made = generator(bytes_.data(), bytes_.size());
    std::array<uint8_t, 16> hash;
    std::copy(made.begin(), made.end(), hash.begin());
    return hash;
  }

 private:
  std::string bytes_;
};

}  // namespace

FrameIdentity IdentityOf(const Readback& readback, const std::optional<FrameNumber>& number) {
  Content content;
  // Equal values are equal bytes, though a map of them in general need not be: this message has
  // none.
  content.AddText(CameraToProto(readback.camera, readback.depth_kind).SerializeAsString());
  content.AddImage(readback.depth, std::max(1, readback.camera.width));
  return {number, content.Hash()};
}

std::string IdentityText(const FrameIdentity& identity) {
  if (identity.number.has_value()) return absl::StrCat("frame ", identity.number->Text());
  const std::string hash(identity.hash.begin(), identity.hash.begin() + 4);
  return absl::StrCat("a frame without a number (", absl::BytesToHexString(hash), ")");
}

std::optional<FrameIdentity> FirstInBoth(absl::Span<const FrameIdentity> a,
                                         absl::Span<const FrameIdentity> b) {
  const auto& few = a.size() < b.size() ? a : b;
  const auto& many = a.size() < b.size() ? b : a;
  auto from = many.begin();
  for (const FrameIdentity& frame : few) {
    from = std::lower_bound(from, many.end(), frame);
    if (from == many.end()) return std::nullopt;
    if (*from == frame) return frame;
  }
  return std::nullopt;
}

void InsertInOrder(absl::Span<const FrameIdentity> more, std::vector<FrameIdentity>* frames) {
  if (more.size() == 1) {
    frames->insert(std::upper_bound(frames->begin(), frames->end(), more[0]), more[0]);
    return;
  }
  const auto middle = static_cast<std::ptrdiff_t>(frames->size());
  frames->insert(frames->end(), more.begin(), more.end());
  std::inplace_merge(frames->begin(), frames->begin() + middle, frames->end());
}

std::vector<FrameNumber> NumbersOfSeveral(absl::Span<const FrameIdentity> frames) {
  std::vector<FrameNumber> numbers;
  for (size_t i = 1; i < frames.size(); ++i) {
    if (!frames[i].number.has_value() || frames[i].number != frames[i - 1].number) continue;
    if (numbers.empty() || numbers.back() != *frames[i].number) {
      numbers.push_back(*frames[i].number);
    }
  }
  return numbers;
}

}  // namespace lightfit
