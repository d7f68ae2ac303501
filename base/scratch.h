// base/scratch.h : working memory from a pool, so that a frame loop allocates nothing.
//
// In:   a ScratchPool that lives as long as the loop, a ScratchScope around each frame's work.
// Out:  ScratchVector, ScratchString: what geometry/ and optimizer/ keep everything in.
// Why:  a fit makes about a thousand small containers. In a thread of an engine each of them would
//       take the heap's lock from the render thread; from a pool they cost a few instructions.
//
//   ScratchPool pool;                    // once, in the optimizer's thread
//   std::vector<LightMatrix> kept(n);    // made outside of the scope
//   while (...) {
//     const ScratchScope scope(&pool);
//     const LightMatrices matrices = FitLights(...);   // allocates nothing after a few frames
//     if (matrices[i].ok()) kept[i] = *matrices[i];    // a copy, in memory of its own
//   }
//
// The rule: a container takes its memory from where the thread's innermost scope points at the time
// it is made (by default or as a copy), keeps to it for life, and must not outlive it. Assigning,
// by copy or by move, leaves the target where it is: a result kept from frame to frame that was
// made outside of any scope never refers to the pool. A container that is *move-constructed* takes
// over the memory of the one it came from, and its origin with it. Outside of any scope all of this
// is operator new and delete.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <string>
#include <type_traits>
#include <vector>

namespace lightfit {

// Memory in blocks of a power of two bytes, kept when they are freed for the next who wants that
// size. Asks `upstream` only for what it has not got yet, so that work which repeats itself
// allocates nothing from the second time on. (std::pmr::unsynchronized_pool_resource hands large
// blocks back each time.) Gives everything back when destroyed.
//
// For one thread: allocate and free in the thread that the pool belongs to.
class ScratchPool final : public std::pmr::memory_resource {
 public:
  // `upstream` must outlive the pool.
  explicit ScratchPool(std::pmr::memory_resource* upstream = std::pmr::new_delete_resource())
      : upstream_(upstream) {}
  ~ScratchPool() override;
  ScratchPool(const ScratchPool&) = delete;
  ScratchPool& operator=(const ScratchPool&) = delete;

  // What was taken from upstream so far. Neither ever falls.
  int64_t num_blocks() const { return num_blocks_; }
  int64_t num_bytes() const { return num_bytes_; }

 private:
  // Stands at the end of each block, whose beginning is aligned to kAlignment.
  struct Block {
    Block* next_free;  // of the same size
    Block* next;       // of all
    size_t size;       // bytes before this
  };

  // Also the smallest size: a cache line. Requests for more alignment go straight to upstream.
  static constexpr size_t kAlignment = 64;

  void* do_allocate(size_t bytes, size_t alignment) override;
  void do_deallocate(void* memory, size_t bytes, size_t alignment) override;
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::pmr::memory_resource* upstream_;
  std::array<Block*, 64> free_ = {};  // by the logarithm of their size
  Block* blocks_ = nullptr;
  int64_t num_blocks_ = 0;
  int64_t num_bytes_ = 0;
};

// While it lives, scratch containers that are made in this thread draw from `resource`; null stands
// for operator new and delete. Scopes nest, and end in the reverse order of their beginning.
class ScratchScope {
 public:
  explicit ScratchScope(std::pmr::memory_resource* resource);
  ~ScratchScope();
  ScratchScope(const ScratchScope&) = delete;
  ScratchScope& operator=(const ScratchScope&) = delete;

  // That of this thread's innermost scope; null outside of any.
  static std::pmr::memory_resource* Current();

 private:
  std::pmr::memory_resource* outer_;
};

// Remembers the resource that was current when it was made. It propagates as
// std::pmr::polymorphic_allocator does: with moved-from containers into new ones, never by
// assignment. Containers of different resources must not be swapped.
template <typename T>
class ScratchAllocator {
 public:
  using value_type = T;
  using is_always_equal = std::false_type;

  ScratchAllocator() : resource_(ScratchScope::Current()) {}
  template <typename U>
  ScratchAllocator(const ScratchAllocator<U>& other)  // NOLINT(google-explicit-constructor)
      : resource_(other.resource()) {}

  // Containers ask for no more than std::allocator_traits::max_size(), which does not overflow.
  T* allocate(size_t n) {
    if (resource_ == nullptr) return std::allocator<T>().allocate(n);
    return static_cast<T*>(resource_->allocate(n * sizeof(T), alignof(T)));
  }
  void deallocate(T* memory, size_t n) {
    if (resource_ == nullptr) return std::allocator<T>().deallocate(memory, n);
    resource_->deallocate(memory, n * sizeof(T), alignof(T));
  }

  ScratchAllocator select_on_container_copy_construction() const { return {}; }
  std::pmr::memory_resource* resource() const { return resource_; }

  friend bool operator==(const ScratchAllocator& a, const ScratchAllocator& b) {
    return a.resource_ == b.resource_;
  }

 private:
  std::pmr::memory_resource* resource_;
};

template <typename T>
using ScratchVector = std::vector<T, ScratchAllocator<T>>;

using ScratchString = std::basic_string<char, std::char_traits<char>, ScratchAllocator<char>>;

}  // namespace lightfit
