#include "scenes/gltf/accessor.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lightfit::gltf {

namespace {

enum class Kind { kByte, kUnsignedByte, kShort, kUnsignedShort, kInt, kUnsignedInt, kFloat };

struct Component {
  Kind kind;
  int64_t num_bytes;
  double scale;  // of the largest value of a normalized one to 1
};

absl::StatusOr<Component> ComponentOf(const Json& object, absl::string_view where) {
  constexpr std::pair<int64_t, Component> kTypes[] = {
      {5120, {Kind::kByte, 1, 1.0 / 127.0}},
      {5121, {Kind::kUnsignedByte, 1, 1.0 / 255.0}},
      {5122, {Kind::kShort, 2, 1.0 / 32767.0}},
      {5123, {Kind::kUnsignedShort, 2, 1.0 / 65535.0}},
      {5124, {Kind::kInt, 4, 1.0 / 2147483647.0}},
      {5125, {Kind::kUnsignedInt, 4, 1.0 / 4294967295.0}},
      {5126, {Kind::kFloat, 4, 1.0}}};
  const absl::StatusOr<int64_t> type = IntegerIn(object, "componentType", where);
  if (!type.ok()) return type.status();
  for (const auto& [number, component] : kTypes) {
    if (number == *type) return component;
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("%s.componentType = %d, want 5120 to 5126", where, *type));
}

template <typename T>
double Load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

double ValueAt(Kind kind, const char* bytes) {
  switch (kind) {
    case Kind::kByte:
      return Load<int8_t>(bytes);
    case Kind::kUnsignedByte:
      return Load<uint8_t>(bytes);
    case Kind::kShort:
      return Load<int16_t>(bytes);
    case Kind::kUnsignedShort:
      return Load<uint16_t>(bytes);
    case Kind::kInt:
      return Load<int32_t>(bytes);
    case Kind::kUnsignedInt:
      return Load<uint32_t>(bytes);
    case Kind::kFloat:
      return Load<float>(bytes);
  }
  return 0.0;
}

int ComponentsOf(absl::string_view type) {
  constexpr std::pair<absl::string_view, int> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  for (const auto& [name, components] : kTypes) {
    if (name == type) return components;
  }
  return 0;
}

// Where elements of `element_bytes` lie.
struct Place {
  const char* first = nullptr;
  int64_t stride = 0;
};

absl::StatusOr<Place> PlaceOf(Document* document,
                              const Json& object,
                              int64_t count,
                              int64_t element_bytes,
                              absl::string_view where) {
  const absl::StatusOr<int64_t> view_index = IntegerIn(object, "bufferView", where);
  if (!view_index.ok()) return view_index.status();
  const absl::StatusOr<int64_t> offset = IntegerIn(object, "byteOffset", where, 0);
  if (!offset.ok()) return offset.status();
  const absl::StatusOr<View> view = document->BufferView(*view_index);
  if (!view.ok()) return view.status();
  const int64_t stride = view->stride == 0 ? element_bytes : view->stride;
  const auto size = static_cast<int64_t>(view->bytes.size());
  // The last element need not be followed by a gap.
  const bool fits = stride >= element_bytes && *offset <= size &&
                    (count == 0 || (element_bytes <= size - *offset &&
                                    count - 1 <= (size - *offset - element_bytes) / stride));
  if (!fits) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: %d elements of %d bytes, %d apart from byte %d on, do not fit into the "
        "%d bytes of bufferViews[%d]",
        where,
        count,
        element_bytes,
        stride,
        *offset,
        size,
        *view_index));
  }
  return Place{view->bytes.data() + *offset, stride};
}

void Load(const Place& place, const Component& component, bool normalized, Numbers* numbers) {
  double* value = numbers->values.data();
  for (int64_t i = 0; i < numbers->count; ++i) {
    const char* bytes = place.first + i * place.stride;
    for (int k = 0; k < numbers->components; ++k, bytes += component.num_bytes) {
      *value = ValueAt(component.kind, bytes);
      if (normalized) *value = std::max(*value * component.scale, -1.0);
      ++value;
    }
  }
}

// Puts the sparse elements into `numbers`.
absl::Status LoadSparse(Document* document,
                        const Json& sparse,
                        const Component& component,
                        bool normalized,
                        const std::string& where,
                        Numbers* numbers) {
  const absl::StatusOr<int64_t> count = IntegerIn(sparse, "count", where);
  if (!count.ok()) return count.status();
  const Json* indices = Member(sparse, "indices");
  const Json* values = Member(sparse, "values");
  if (indices == nullptr || values == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat(where, ": want indices and values"));
  }
  const absl::StatusOr<Component> index_component = ComponentOf(*indices, where + ".indices");
  if (!index_component.ok()) return index_component.status();
  const int64_t value_bytes = numbers->components * component.num_bytes;
  const absl::StatusOr<Place> index_place =
      PlaceOf(document, *indices, *count, index_component->num_bytes, where + ".indices");
  if (!index_place.ok()) return index_place.status();
  const absl::StatusOr<Place> value_place =
      PlaceOf(document, *values, *count, value_bytes, where + ".values");
  if (!value_place.ok()) return value_place.status();
  if (absl::Status status = document->Take(*count * (1 + numbers->components), 0); !status.ok()) {
    return status;
  }
  Numbers replaced{*count, numbers->components, {}};
  replaced.values.resize(static_cast<size_t>(*count * numbers->components));
  Load(*value_place, component, normalized, &replaced);
  for (int64_t i = 0; i < *count; ++i) {
    const double index =
        ValueAt(index_component->kind, index_place->first + i * index_place->stride);
    if (!(index >= 0.0 && index < static_cast<double>(numbers->count))) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s.indices: %g is beyond the %d elements", where, index, numbers->count));
    }
    std::copy_n(replaced.values.begin() + i * numbers->components,
                numbers->components,
                numbers->values.begin() + static_cast<int64_t>(index) * numbers->components);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<int64_t> CountOf(const Document& document, int64_t index) {
  const absl::StatusOr<const Json*> accessor = document.Element("accessors", index);
  if (!accessor.ok()) return accessor.status();
  return IntegerIn(**accessor, "count", absl::StrFormat("accessors[%d]", index));
}

absl::StatusOr<Numbers> ReadAccessor(Document* document, int64_t index, int components) {
  const absl::StatusOr<const Json*> accessor = document->Element("accessors", index);
  if (!accessor.ok()) return accessor.status();
  const Json& object = **accessor;
  const std::string where = absl::StrFormat("accessors[%d]", index);
  const absl::StatusOr<Component> component = ComponentOf(object, where);
  if (!component.ok()) return component.status();
  const absl::StatusOr<int64_t> count = IntegerIn(object, "count", where);
  if (!count.ok()) return count.status();
  const std::string type = TextIn(object, "type");
  if (ComponentsOf(type) != components) {
    return absl::InvalidArgumentError(absl::StrFormat("%s.type = \"%s\", want %d numbers each",
                                                      where,
                                                      absl::CHexEscape(type.substr(0, 20)),
                                                      components));
  }
  const bool normalized = FlagIn(object, "normalized", false);
  Place place;
  const bool has_view = Member(object, "bufferView") != nullptr;
  if (has_view) {
    const absl::StatusOr<Place> found =
        PlaceOf(document, object, *count, components * component->num_bytes, where);
    if (!found.ok()) return found.status();
    place = *found;
  }
  // Before memory is taken: without a view there are as many zeros as the file says.
  if (*count > INT32_MAX) {
    return absl::InvalidArgumentError(absl::StrFormat("%s.count = %d is too many", where, *count));
  }
  if (absl::Status status = document->Take(*count * components, 0); !status.ok()) return status;
  Numbers numbers{*count, components, {}};
  numbers.values.resize(static_cast<size_t>(*count * components));
  if (has_view) Load(place, *component, normalized, &numbers);
  if (const Json* sparse = Member(object, "sparse")) {
    absl::Status status =
        LoadSparse(document, *sparse, *component, normalized, where + ".sparse", &numbers);
    if (!status.ok()) return status;
  }
  return numbers;
}

}  // namespace lightfit::gltf
