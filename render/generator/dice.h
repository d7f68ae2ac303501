// render/generator/dice.h
//
// Random numbers that are the same on every machine.
//
// Draw one number a statement: compilers are free to evaluate arguments in any order.
#pragma once

#include <cstdint>
#include <random>

namespace lightfit {

class Dice {
 public:
  explicit Dice(uint64_t seed) : engine_(seed) {}

  // The distributions of <random> differ from library to library.
  double Uniform(double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(engine_() >> 11);
  }
  int Below(int count) { return static_cast<int>(engine_() % static_cast<uint64_t>(count)); }
  bool Chance(double share) { return Uniform(0.0, 1.0) < share; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace lightfit
