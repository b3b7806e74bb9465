// Linked into the program where benchmarks are built: `diminish bench` then says what a frame
// allocates. With the GNU C library only, and not where a sanitizer replaces malloc.
#include "allocations.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include <atomic>
#include <cerrno>

namespace {

std::atomic<std::size_t> total_count = 0;
std::atomic<std::size_t> total_bytes = 0;

void count(std::size_t bytes) {
  total_count.fetch_add(1, std::memory_order_relaxed);
  total_bytes.fetch_add(bytes, std::memory_order_relaxed);
}

diminish::Allocations counted() {
  return {total_count.load(std::memory_order_relaxed), total_bytes.load(std::memory_order_relaxed)};
}

const bool is_counting = (diminish::count_allocations = counted) != nullptr;

}  // namespace

// A program's own malloc takes the place of the library's in every shared library; it passes on to
// the functions that the GNU C library exports for that purpose.
extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  count(size);
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  count(number * size);
  return __libc_calloc(number, size);
}
void* realloc(void* old, std::size_t size) {
  count(size);
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count(size);
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count(size);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  count(size);
  *result = __libc_memalign(alignment, size);
  return *result ? 0 : ENOMEM;
}

}  // extern "C"

#endif
