#include "base/scratch.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "geometry/convex_hull.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;

// Counts, and knows what is out, with which size and alignment.
class Upstream final : public std::pmr::memory_resource {
 public:
  int64_t num_allocated() const { return num_allocated_; }
  int64_t num_out() const { return static_cast<int64_t>(out_.size()); }
  int64_t bytes_out() const {
    return std::accumulate(out_.begin(), out_.end(), int64_t{0}, [](int64_t sum, const auto& out) {
      return sum + static_cast<int64_t>(out.second.first);
    });
  }

 private:
  void* do_allocate(size_t bytes, size_t alignment) override {
    void* memory = std::pmr::new_delete_resource()->allocate(bytes, alignment);
    out_[memory] = {bytes, alignment};
    ++num_allocated_;
    return memory;
  }
  void do_deallocate(void* memory, size_t bytes, size_t alignment) override {
    const auto found = out_.find(memory);
    ASSERT_TRUE(found != out_.end());
    EXPECT_EQ(found->second, std::pair(bytes, alignment));
    out_.erase(found);
    std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::map<void*, std::pair<size_t, size_t>> out_;
  int64_t num_allocated_ = 0;
};

TEST(ScratchPool, TakesABlockOfEachSizeOnce) {
  Upstream upstream;
  ScratchPool pool(&upstream);
  for (int round = 0; round < 3; ++round) {
    void* small = pool.allocate(65, 8);
    void* other_small = pool.allocate(128, 8);
    void* large = pool.allocate(1 << 20, 16);
    EXPECT_NE(small, other_small);
    pool.deallocate(small, 65, 8);
    EXPECT_EQ(pool.allocate(100, 8), small);  // the same class of sizes
    pool.deallocate(small, 100, 8);
    pool.deallocate(other_small, 128, 8);
    pool.deallocate(large, 1 << 20, 16);
    EXPECT_EQ(pool.num_blocks(), 3);
    EXPECT_EQ(upstream.num_allocated(), 3);
    EXPECT_EQ(pool.num_bytes(), upstream.bytes_out());
  }
}

TEST(ScratchPool, GivesEverythingBackWhenDestroyed) {
  Upstream upstream;
  {
    ScratchPool pool(&upstream);
    void* kept = pool.allocate(1000, 8);
    pool.deallocate(pool.allocate(10, 8), 10, 8);
    EXPECT_NE(kept, nullptr);
    EXPECT_EQ(upstream.num_out(), 2);
  }
  EXPECT_EQ(upstream.num_out(), 0);
}

TEST(ScratchPool, AlignsAsAsked) {
  Upstream upstream;
  {
    ScratchPool pool(&upstream);
    for (size_t alignment = 1; alignment <= 4096; alignment *= 2) {
      for (const size_t bytes : {size_t{0}, size_t{1}, size_t{63}, size_t{64}, size_t{5000}}) {
        void* memory = pool.allocate(bytes, alignment);
        EXPECT_EQ(reinterpret_cast<uintptr_t>(memory) % alignment, 0u) << bytes;
        if (bytes > 0) std::memset(memory, 0xff, bytes);
        pool.deallocate(memory, bytes, alignment);
      }
    }
  }
  EXPECT_EQ(upstream.num_out(), 0);
}

// What is out at the same time never overlaps, nor does the pool write into it.
TEST(ScratchPool, KeepsBlocksApart) {
  Random random(1);
  Upstream upstream;
  ScratchPool pool(&upstream);
  struct Lent {
    unsigned char* memory;
    size_t bytes;
    unsigned char value;
  };
  std::vector<Lent> lent;
  for (int step = 0; step < 5000; ++step) {
    if (lent.size() < 20 || (lent.size() < 60 && random.Coin())) {
      const size_t bytes = static_cast<size_t>(random.LogUniform(1.0, 20000.0));
      auto* memory = static_cast<unsigned char*>(pool.allocate(bytes, 16));
      const auto value = static_cast<unsigned char>(random.Int(0, 255));
      std::memset(memory, value, bytes);
      lent.push_back({memory, bytes, value});
    } else {
      std::swap(lent[random.Int(0, static_cast<int>(lent.size()) - 1)], lent.back());
      const Lent& back = lent.back();
      for (size_t i = 0; i < back.bytes; ++i) ASSERT_EQ(back.memory[i], back.value);
      pool.deallocate(back.memory, back.bytes, 16);
      lent.pop_back();
    }
  }
  EXPECT_LT(pool.num_blocks(), 600);  // of about 2500 allocations
}

TEST(ScratchScope, NestsAndEnds) {
  ScratchPool outer_pool, inner_pool;
  EXPECT_EQ(ScratchScope::Current(), nullptr);
  {
    const ScratchScope outer(&outer_pool);
    EXPECT_EQ(ScratchVector<int>().get_allocator().resource(), &outer_pool);
    {
      const ScratchScope inner(&inner_pool);
      EXPECT_EQ(ScratchVector<int>(10).get_allocator().resource(), &inner_pool);
      const ScratchScope none(nullptr);
      EXPECT_EQ(ScratchString("made outside").get_allocator().resource(), nullptr);
    }
    EXPECT_EQ(ScratchScope::Current(), &outer_pool);
  }
  EXPECT_EQ(ScratchScope::Current(), nullptr);
  EXPECT_EQ(outer_pool.num_blocks(), 0);
  EXPECT_EQ(inner_pool.num_blocks(), 1);
}

TEST(ScratchScope, HoldsForItsOwnThreadOnly) {
  ScratchPool pool;
  const ScratchScope scope(&pool);
  std::thread([] {
    EXPECT_EQ(ScratchScope::Current(), nullptr);
    const ScratchVector<double> numbers(100, 1.0);
    EXPECT_EQ(numbers.get_allocator().resource(), nullptr);
  }).join();
  EXPECT_EQ(pool.num_blocks(), 0);
}

TEST(ScratchVector, CopiesDrawFromTheScopeTheyAreMadeIn) {
  ScratchPool pool;
  const ScratchVector<int> outside(100, 7);
  {
    const ScratchScope scope(&pool);
    const ScratchVector<int> copy = outside;
    EXPECT_EQ(copy.get_allocator().resource(), &pool);
    EXPECT_EQ(copy, outside);
    const ScratchVector<int> back = [&] {
      const ScratchScope none(nullptr);
      return ScratchVector<int>(copy);
    }();
    EXPECT_EQ(back.get_allocator().resource(), nullptr);
  }
}

// What was made outside of a scope can be assigned to in it and outlive the pool.
TEST(ScratchVector, AssignmentKeepsTheTargetsMemory) {
  ScratchVector<int> copied, moved;
  ScratchVector<ScratchVector<int>> nested(1);
  {
    ScratchPool pool;
    const ScratchScope scope(&pool);
    ScratchVector<int> numbers(1000);
    std::iota(numbers.begin(), numbers.end(), 0);
    copied = numbers;
    nested[0] = numbers;
    moved = std::move(numbers);
  }
  for (const ScratchVector<int>* kept : {&copied, &moved, &nested[0]}) {
    EXPECT_EQ(kept->get_allocator().resource(), nullptr);
    ASSERT_EQ(kept->size(), 1000u);
    EXPECT_EQ((*kept)[999], 999);
  }
}

TEST(ScratchVector, MovesTakeTheMemoryAlong) {
  ScratchPool pool;
  const ScratchScope scope(&pool);
  ScratchVector<int> numbers(1000, 3);
  const int* data = numbers.data();
  {
    const ScratchScope none(nullptr);
    const ScratchVector<int> moved = std::move(numbers);
    EXPECT_EQ(moved.data(), data);
    EXPECT_EQ(moved.get_allocator().resource(), &pool);
  }
  ScratchVector<int> assigned;
  ScratchVector<int> others(2000, 4);
  data = others.data();
  assigned = std::move(others);  // of the same pool
  EXPECT_EQ(assigned.data(), data);
}

TEST(ScratchVector, WorksAsBeforeOutsideOfAnyScope) {
  struct alignas(128) Wide {
    double value = 1.0;
  };
  const ScratchVector<Wide> wide(5);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(wide.data()) % 128, 0u);
  ScratchPool pool;
  const ScratchScope scope(&pool);
  const ScratchVector<Wide> wide_in_pool(5);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(wide_in_pool.data()) % 128, 0u);
}

// The hull of the same points is the same wherever its memory comes from, and costs nothing from
// the second time on.
TEST(ScratchPool, ServesTheSecondHullFromTheFirst) {
  Random random(2);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 500; ++i) points.push_back(random.InCube(10.0).head<2>());
  const Polygon expected = ConvexHull(points);
  ScratchPool pool;
  const ScratchScope scope(&pool);
  EXPECT_EQ(ConvexHull(points), expected);
  const int64_t num_blocks = pool.num_blocks();
  EXPECT_GT(num_blocks, 0);
  for (int round = 0; round < 3; ++round) EXPECT_EQ(ConvexHull(points), expected);
  EXPECT_EQ(pool.num_blocks(), num_blocks);
}

}  // namespace
}  // namespace lightfit
