#include "fuzz/mutate_message.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

#include "wire/utf8.h"

namespace lightfit::fuzz {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDoubles[] = {0.0,
                               -0.0,
                               1.0,
                               -1.0,
                               0.5,
                               1e-3,
                               1e9,
                               1e-300,
                               5e-324,
                               1e100,
                               1e154,
                               1e308,
                               -1e308,
                               kInfinity,
                               -kInfinity,
                               std::numeric_limits<double>::quiet_NaN()};
constexpr int64_t kIntegers[] = {0, 1, -1, 2, 7, 32, 33, 1000, 1001, 65536, 65537, 1 << 30};

class Mutation {
 public:
  Mutation(const MutateBytes& mutate_bytes, std::mt19937* random)
      : mutate_bytes_(mutate_bytes), random_(*random) {}

  void Change(Message* message) {
    const google::protobuf::Descriptor& type = *message->GetDescriptor();
    if (type.field_count() == 0) return;
    const FieldDescriptor& field = *type.field(static_cast<int>(Below(type.field_count())));
    if (field.is_repeated()) {
      ChangeRepeated(message, field);
    } else if (message->GetReflection()->HasField(*message, &field) && Below(8) == 0) {
      message->GetReflection()->ClearField(message, &field);
    } else {
      SetSingular(message, field);
    }
  }

  size_t Below(size_t limit) { return random_() % limit; }

 private:
  double Changed(double value) {
    switch (Below(5)) {
      case 0:
        return kDoubles[Below(std::size(kDoubles))];
      case 1:
        return -value;
      case 2:
        return std::ldexp(value, static_cast<int>(Below(41)) - 20);
      case 3:
        return std::nextafter(value, Below(2) == 0 ? kInfinity : -kInfinity);
      default:
        return value + std::uniform_real_distribution<double>(-2.0, 2.0)(random_);
    }
  }

  int64_t Changed(int64_t value, int64_t max) {
    switch (Below(4)) {
      case 0:
        return kIntegers[Below(std::size(kIntegers))];
      case 1:
        return Below(2) == 0 ? max : -max - 1;
      case 2:
        return static_cast<int64_t>(static_cast<uint64_t>(value) ^ uint64_t{1} << Below(31));
      default:
        return static_cast<int64_t>(static_cast<uint64_t>(value) + Below(9) - 4);
    }
  }

  std::string Changed(std::string bytes, const FieldDescriptor& field) {
    if (bytes.size() >= 4 && Below(2) == 0) {
      // One word, as in arrays of float: the length stays.
      const auto word = static_cast<float>(Changed(1.0));
      const auto* const from = reinterpret_cast<const char*>(&word);
      std::copy(from, from + 4, bytes.begin() + static_cast<int64_t>(Below(bytes.size() / 4) * 4));
    } else {
      mutate_bytes_(&bytes);
    }
    return field.type() == FieldDescriptor::TYPE_STRING ? Utf8Text(bytes) : bytes;
  }

  void SetSingular(Message* message, const FieldDescriptor& field) {
    const Reflection& reflection = *message->GetReflection();
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE:
        reflection.MutableMessage(message, &field);
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        reflection.SetDouble(message, &field, Changed(reflection.GetDouble(*message, &field)));
        break;
      case FieldDescriptor::CPPTYPE_INT32:
        reflection.SetInt32(message,
                            &field,
                            static_cast<int32_t>(Changed(reflection.GetInt32(*message, &field),
                                                         std::numeric_limits<int32_t>::max())));
        break;
      case FieldDescriptor::CPPTYPE_INT64:
        reflection.SetInt64(
            message,
            &field,
            Changed(reflection.GetInt64(*message, &field), std::numeric_limits<int64_t>::max()));
        break;
      case FieldDescriptor::CPPTYPE_BOOL:
        reflection.SetBool(message, &field, !reflection.GetBool(*message, &field));
        break;
      case FieldDescriptor::CPPTYPE_ENUM:
        reflection.SetEnumValue(
            message,
            &field,
            static_cast<int>(Below(field.enum_type()->value_count() + 1)));  // one is unknown
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        reflection.SetString(
            message, &field, Changed(reflection.GetString(*message, &field), field));
        break;
      default:
        break;  // the schema has no other types
    }
  }

  void ChangeRepeated(Message* message, const FieldDescriptor& field) {
    const Reflection& reflection = *message->GetReflection();
    const int size = reflection.FieldSize(*message, &field);
    if (size == 0 || Below(4) == 0) {
      Add(message, field);
      return;
    }
    const int last = size - 1, any = static_cast<int>(Below(size));
    switch (Below(4)) {
      case 0:
        reflection.SwapElements(message, &field, any, last);
        return;
      case 1:
        reflection.SwapElements(message, &field, any, last);
        reflection.RemoveLast(message, &field);
        return;
      default:
        ChangeElement(message, field, any);
    }
  }

  // A new element: empty, or another one again.
  void Add(Message* message, const FieldDescriptor& field) {
    const Reflection& reflection = *message->GetReflection();
    const int size = reflection.FieldSize(*message, &field);
    const int from = size == 0 ? -1 : static_cast<int>(Below(size));
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE: {
        Message* const added = reflection.AddMessage(message, &field);
        if (from >= 0) added->CopyFrom(reflection.GetRepeatedMessage(*message, &field, from));
        break;
      }
      case FieldDescriptor::CPPTYPE_DOUBLE:
        reflection.AddDouble(message, &field, Changed(1.0));
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        reflection.AddString(
            message,
            &field,
            from < 0 ? std::string() : reflection.GetRepeatedString(*message, &field, from));
        break;
      default:
        break;  // the schema has no other lists
    }
  }

  void ChangeElement(Message* message, const FieldDescriptor& field, int index) {
    const Reflection& reflection = *message->GetReflection();
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE:
        Change(reflection.MutableRepeatedMessage(message, &field, index));
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        reflection.SetRepeatedDouble(
            message, &field, index, Changed(reflection.GetRepeatedDouble(*message, &field, index)));
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        reflection.SetRepeatedString(
            message,
            &field,
            index,
            Changed(reflection.GetRepeatedString(*message, &field, index), field));
        break;
      default:
        break;
    }
  }

  const MutateBytes& mutate_bytes_;
  std::mt19937& random_;
};

// The message and all that it holds.
void ListMessages(Message* message, std::vector<Message*>* all) {
  all->push_back(message);
  const Reflection& reflection = *message->GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(*message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    if (!field->is_repeated()) {
      ListMessages(reflection.MutableMessage(message, field), all);
      continue;
    }
    for (int i = 0; i < reflection.FieldSize(*message, field); ++i) {
      ListMessages(reflection.MutableRepeatedMessage(message, field, i), all);
    }
  }
}

}  // namespace

void MutateMessage(Message* message, const MutateBytes& mutate_bytes, std::mt19937* random) {
  std::vector<Message*> all;
  ListMessages(message, &all);
  Mutation mutation(mutate_bytes, random);
  mutation.Change(all[mutation.Below(all.size())]);
}

}  // namespace lightfit::fuzz
