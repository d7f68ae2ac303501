// fuzz/mutate_message.h
//
// One change to a message: a field gets another value, appears, goes, is there twice or elsewhere.
// In:   a message of any type, a source of randomness.
// Out:  the message, other than it was (mostly), and valid as bytes.
#pragma once

#include <google/protobuf/message.h>

#include <functional>
#include <random>
#include <string>

namespace lightfit::fuzz {

// Changes some bytes of a string.
using MutateBytes = std::function<void(std::string* bytes)>;

// Numbers often become what parsers stumble over: NaN, infinities, 0, the largest integers.
void MutateMessage(google::protobuf::Message* message,
                   const MutateBytes& mutate_bytes,
                   std::mt19937* random);

}  // namespace lightfit::fuzz
