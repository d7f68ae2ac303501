#include "base/scratch.h"

#include <algorithm>
#include <bit>

namespace lightfit {

namespace {

constinit thread_local std::pmr::memory_resource* current_resource = nullptr;

}  // namespace

ScratchPool::~ScratchPool() {
  while (blocks_ != nullptr) {
    Block* block = blocks_;
    blocks_ = block->next;
    const size_t size = block->size;
    upstream_->deallocate(
        reinterpret_cast<std::byte*>(block) - size, size + sizeof(Block), kAlignment);
  }
}

void* ScratchPool::do_allocate(size_t bytes, size_t alignment) {
  if (alignment > kAlignment) return upstream_->allocate(bytes, alignment);
  const size_t size = std::bit_ceil(std::max(bytes, kAlignment));
  Block*& free = free_[std::countr_zero(size)];
  if (free != nullptr) {
    std::byte* memory = reinterpret_cast<std::byte*>(free) - size;
    free = free->next_free;
    return memory;
  }
  auto* memory = static_cast<std::byte*>(upstream_->allocate(size + sizeof(Block), kAlignment));
  blocks_ = new (memory + size) Block{nullptr, blocks_, size};
  ++num_blocks_;
  num_bytes_ += static_cast<int64_t>(size + sizeof(Block));
  return memory;
}

void ScratchPool::do_deallocate(void* memory, size_t bytes, size_t alignment) {
  if (alignment > kAlignment) return upstream_->deallocate(memory, bytes, alignment);
  const size_t size = std::bit_ceil(std::max(bytes, kAlignment));
  auto* block = reinterpret_cast<Block*>(static_cast<std::byte*>(memory) + size);
  Block*& free = free_[std::countr_zero(size)];
  block->next_free = free;
  free = block;
}

ScratchScope::ScratchScope(std::pmr::memory_resource* resource) : outer_(current_resource) {
  current_resource = resource;
}

ScratchScope::~ScratchScope() { current_resource = outer_; }

std::pmr::memory_resource* ScratchScope::Current() { return current_resource; }

}  // namespace lightfit
