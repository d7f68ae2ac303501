#include "scenes/gltf/json.h"

#include <cmath>

#include "absl/strings/str_format.h"

namespace lightfit::gltf {

const Json* Member(const Json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

const Json* Extension(const Json& object, const char* extension) {
  const Json* extensions = Member(object, "extensions");
  return extensions == nullptr ? nullptr : Member(*extensions, extension);
}

int64_t LengthOf(const Json& object, const char* name) {
  const Json* list = Member(object, name);
  return list != nullptr && list->is_array() ? static_cast<int64_t>(list->size()) : 0;
}

absl::StatusOr<int64_t> IntegerIn(const Json& object,
                                  const char* name,
                                  absl::string_view where,
                                  std::optional<int64_t> absent) {
  constexpr double kMax = 9007199254740992.0;
  const Json* member = Member(object, name);
  if (member == nullptr && absent.has_value()) return *absent;
  const double value = member != nullptr && member->is_number() ? member->get<double>() : -1.0;
  if (!(value >= 0.0 && value <= kMax) || value != std::floor(value)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s.%s: want a whole number from 0 on", where, name));
  }
  return static_cast<int64_t>(value);
}

absl::StatusOr<double> NumberIn(const Json& object,
                                const char* name,
                                absl::string_view where,
                                std::optional<double> absent) {
  const Json* member = Member(object, name);
  if (member == nullptr && absent.has_value()) return *absent;
  if (member == nullptr || !member->is_number() || !std::isfinite(member->get<double>())) {
    return absl::InvalidArgumentError(absl::StrFormat("%s.%s: want a number", where, name));
  }
  return member->get<double>();
}

absl::StatusOr<bool> NumbersIn(const Json& object,
                               const char* name,
                               absl::string_view where,
                               absl::Span<double> numbers) {
  const Json* member = Member(object, name);
  if (member == nullptr) return false;
  bool good = member->is_array() && member->size() == numbers.size();
  for (size_t i = 0; good && i < numbers.size(); ++i) {
    const Json& item = (*member)[i];
    good = item.is_number() && std::isfinite(item.get<double>());
    if (good) numbers[i] = item.get<double>();
  }
  if (good) return true;
  return absl::InvalidArgumentError(
      absl::StrFormat("%s.%s: want %d numbers", where, name, numbers.size()));
}

bool FlagIn(const Json& object, const char* name, bool absent) {
  const Json* member = Member(object, name);
  return member != nullptr && member->is_boolean() ? member->get<bool>() : absent;
}

std::string TextIn(const Json& object, const char* name) {
  const Json* member = Member(object, name);
  return member != nullptr && member->is_string() ? member->get<std::string>() : "";
}

}  // namespace lightfit::gltf
