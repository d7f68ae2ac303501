#include "optimizer/readback/kernels.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimizer/readback/kernels.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lightfit::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

DepthStatistics ScanDepthSimd(const float* depth,
                              const uint32_t* bits,
                              uint32_t mask,
                              size_t stride,
                              size_t columns,
                              size_t rows,
                              const DepthIntervals& intervals) {
  const hn::CappedTag<float, 16> tag;
  const hn::RebindToUnsigned<decltype(tag)> bits_tag;
  const size_t lanes = hn::Lanes(tag);
  const auto mask_vector = hn::Set(bits_tag, bits == nullptr ? ~0u : mask);
  const auto all_bits = hn::Set(bits_tag, ~0u);
  const auto surface_min = hn::Set(tag, intervals.surface_min);
  const auto surface_max = hn::Set(tag, intervals.surface_max);
  const auto background_min = hn::Set(tag, intervals.background_min);
  const auto background_max = hn::Set(tag, intervals.background_max);
  auto low = hn::Set(tag, std::numeric_limits<float>::max());
  auto high = hn::Set(tag, std::numeric_limits<float>::lowest());
  // Lanes count in single precision, exact up to 2^24 rows.
  const auto one = hn::Set(tag, 1.0f);
  auto num_surface = hn::Zero(tag);
  auto num_background = hn::Zero(tag);
  const auto accumulate = [&](hn::Vec<decltype(tag)> value,
                              hn::Vec<decltype(bits_tag)> word) HWY_ATTR {
    const auto wanted = hn::RebindMask(tag, hn::Ne(hn::And(word, mask_vector), hn::Zero(bits_tag)));
    const auto surface =
        hn::And(wanted, hn::And(hn::Gt(value, surface_min), hn::Lt(value, surface_max)));
    const auto background = hn::And(hn::Ge(value, background_min), hn::Le(value, background_max));
    low = hn::IfThenElse(surface, hn::Min(low, value), low);
    high = hn::IfThenElse(surface, hn::Max(high, value), high);
    num_surface = hn::Add(num_surface, hn::IfThenElseZero(surface, one));
    num_background = hn::Add(num_background, hn::IfThenElseZero(background, one));
  };
  const size_t whole = columns / lanes * lanes;
  for (size_t y = 0; y < rows; ++y, depth += stride) {
    const uint32_t* row_bits = bits == nullptr ? nullptr : bits + y * stride;
    for (size_t x = 0; x < whole; x += lanes) {
      accumulate(hn::LoadU(tag, depth + x),
                 bits == nullptr ? all_bits : hn::LoadU(bits_tag, row_bits + x));
    }
    if (whole == columns) continue;
    // The last few values, padded with NaN, which is neither surface nor background. (A masked load
    // would read past the end where the processor has none.)
    HWY_ALIGN float padded[16];
    std::fill(padded, padded + 16, std::numeric_limits<float>::quiet_NaN());
    std::copy(depth + whole, depth + columns, padded);
    HWY_ALIGN uint32_t padded_bits[16];
    std::fill(padded_bits, padded_bits + 16, ~0u);
    if (bits != nullptr) std::copy(row_bits + whole, row_bits + columns, padded_bits);
    accumulate(hn::Load(tag, padded), hn::Load(bits_tag, padded_bits));
  }
  DepthStatistics statistics;
  statistics.num_surface = static_cast<int>(hn::GetLane(hn::SumOfLanes(tag, num_surface)));
  statistics.num_background = static_cast<int>(hn::GetLane(hn::SumOfLanes(tag, num_background)));
  statistics.min = hn::GetLane(hn::MinOfLanes(tag, low));
  statistics.max = hn::GetLane(hn::MaxOfLanes(tag, high));
  return statistics;
}

size_t ScanBoundarySimd(
    const uint32_t* row, size_t stride, size_t width, uint32_t mask, int32_t* columns) {
  const hn::CappedTag<uint32_t, 16> tag;
  const size_t lanes = hn::Lanes(tag);
  const auto mask_vector = hn::Set(tag, mask);
  size_t count = 0;
  if (width < 3) return 0;
  size_t x = 1;
  for (; x + lanes < width; x += lanes) {
    const auto here = hn::LoadU(tag, row + x);
    const auto across = hn::Or(hn::Xor(here, hn::LoadU(tag, row + x - 1)),
                               hn::Xor(here, hn::LoadU(tag, row + x + 1)));
    const auto along = hn::Or(hn::Xor(here, hn::LoadU(tag, row + x - stride)),
                              hn::Xor(here, hn::LoadU(tag, row + x + stride)));
    const auto differs = hn::Ne(hn::And(hn::Or(across, along), mask_vector), hn::Zero(tag));
    if (hn::AllFalse(tag, differs)) continue;
    HWY_ALIGN uint8_t bits[8] = {};
    hn::StoreMaskBits(tag, differs, bits);
    uint32_t word = static_cast<uint32_t>(bits[0]) | static_cast<uint32_t>(bits[1]) << 8;
    for (; word != 0; word &= word - 1) {
      columns[count++] = static_cast<int32_t>(x) + __builtin_ctz(word);
    }
  }
  for (; x + 1 < width; ++x) {
    const uint32_t here = row[x];
    const uint32_t differs = (here ^ row[x - 1]) | (here ^ row[x + 1]) |
                             (here ^ *(row + x - stride)) | (here ^ row[x + stride]);
    if ((differs & mask) != 0) columns[count++] = static_cast<int32_t>(x);
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace lightfit::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lightfit::internal {

HWY_EXPORT(ScanDepthSimd);
HWY_EXPORT(ScanBoundarySimd);

DepthStatistics ScanDepth(const float* depth,
                          const uint32_t* bits,
                          uint32_t mask,
                          size_t stride,
                          size_t columns,
                          size_t rows,
                          const DepthIntervals& intervals) {
  return HWY_DYNAMIC_DISPATCH(ScanDepthSimd)(depth, bits, mask, stride, columns, rows, intervals);
}

size_t ScanBoundary(
    const uint32_t* row, size_t stride, size_t width, uint32_t mask, int32_t* columns) {
  return HWY_DYNAMIC_DISPATCH(ScanBoundarySimd)(row, stride, width, mask, columns);
}

}  // namespace lightfit::internal
#endif  // HWY_ONCE
