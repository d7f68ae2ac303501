// scenes/gltf/json.h
//
// Members of JSON objects that may come from anywhere.
// In:   a JSON value; `where` names it in messages, "nodes[3]".
// Out:  its members, or InvalidArgument that names the member and what is wanted.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"

namespace lightfit::gltf {

using Json = nlohmann::json;

// Null when `object` is no object or has no such member.
const Json* Member(const Json& object, const char* name);

// The member of the extension `extension` of `object`, likewise.
const Json* Extension(const Json& object, const char* extension);

// A list's length, 0 when the member is no list.
int64_t LengthOf(const Json& object, const char* name);

// A whole number from 0 to 2^53. Without `absent` it must be there.
absl::StatusOr<int64_t> IntegerIn(const Json& object,
                                  const char* name,
                                  absl::string_view where,
                                  std::optional<int64_t> absent = {});

absl::StatusOr<double> NumberIn(const Json& object,
                                const char* name,
                                absl::string_view where,
                                std::optional<double> absent = {});

// As many finite numbers as `numbers` has; false and nothing written when the member is absent.
absl::StatusOr<bool> NumbersIn(const Json& object,
                               const char* name,
                               absl::string_view where,
                               absl::Span<double> numbers);

bool FlagIn(const Json& object, const char* name, bool absent);

// "" when absent or no text.
std::string TextIn(const Json& object, const char* name);

}  // namespace lightfit::gltf
