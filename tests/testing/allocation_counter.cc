#include "tests/testing/allocation_counter.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstddef>

namespace {

constinit std::atomic<int64_t> num_allocations{0};

void Count() { num_allocations.fetch_add(1, std::memory_order_relaxed); }

}  // namespace

namespace lightfit::testing {

int64_t NumAllocations() { return num_allocations.load(std::memory_order_relaxed); }

}  // namespace lightfit::testing

// g++ says so by a macro, clang by a feature.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LIGHTFIT_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LIGHTFIT_SANITIZED 1
#endif
#endif

// NOLINTBEGIN(bugprone-reserved-identifier): the names are not ours.
#ifdef LIGHTFIT_SANITIZED

// The sanitizers' own heap calls these.
extern "C" void __sanitizer_malloc_hook(const volatile void* /*memory*/, size_t /*size*/) {
  Count();
}
extern "C" void __sanitizer_free_hook(const volatile void* /*memory*/) {}

#else

// The program's malloc goes before that of glibc, whose own names for it begin with __libc.
// operator new calls malloc or aligned_alloc.
extern "C" {

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) {
  Count();
  return __libc_malloc(size);
}

void* calloc(size_t count, size_t size) {
  Count();
  return __libc_calloc(count, size);
}

void* realloc(void* memory, size_t size) {
  Count();
  return __libc_realloc(memory, size);
}

void* memalign(size_t alignment, size_t size) {
  Count();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(size_t alignment, size_t size) {
  Count();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, size_t alignment, size_t size) {
  Count();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

}  // extern "C"

#endif
// NOLINTEND(bugprone-reserved-identifier)
