// A library to be preloaded (LD_PRELOAD): makes one call of the C library fail, the n-th that the
// program makes of it since main() began.
//
//   MINDAHL_FAULT=write:3    the third write() fails
//   MINDAHL_FAULT=write:3+   the third fails and every later one, as on a disk that stays full
//   MINDAHL_FAULT=write:3~   the third writes half of what it is given, later ones fail
//   MINDAHL_FAULT_COUNTS=F   writes to the file F at exit how often each call was made
//
// Programs that it starts (rsvg-convert) and its standard error are left alone.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

extern "C" {
// The allocator of glibc by the names that it has beside those that are replaced here.
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
}

namespace {

enum Call {
  kWrite,
  kOpen,
  kRename,
  kSync,
  kTruncate,
  kClose,
  kMalloc,
  kThread,
  kSystem,
  kDirectory,
  kCalls
};

struct CallRow {
  std::string_view name;
  int error;  // errno where it fails
  std::atomic<long> count;
};
CallRow calls[kCalls] = {{"write", ENOSPC, 0},  {"open", EMFILE, 0},   {"rename", EACCES, 0},
                         {"fsync", EIO, 0},     {"truncate", EIO, 0},  {"close", EIO, 0},
                         {"malloc", ENOMEM, 0}, {"thread", EAGAIN, 0}, {"system", EAGAIN, 0},
                         {"mkdir", ENOSPC, 0}};

bool is_counting = false;
int failing = kCalls;
long first = 0;
bool goes_on = false;
bool halves = false;

/// True for a file that is made, perhaps without a name.
bool TakesMode(int flags) { return (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE; }

/// True if this call is to fail; counts it.
bool Fails(Call call) {
  if (!is_counting) return false;
  const long number = ++calls[call].count;
  if (call != failing) return false;
  const bool fails = number == first ? !halves : number > first && (goes_on || halves);
  if (fails) errno = calls[call].error;
  return fails;
}

bool IsHalved(Call call) { return halves && call == failing && calls[call].count == first; }

void ReadFault() {
  const char* const fault = std::getenv("MINDAHL_FAULT");
  if (fault == nullptr) return;
  const std::string_view text(fault);
  const size_t colon = text.find(':');
  for (int call = 0; call < kCalls; ++call) {
    if (calls[call].name == text.substr(0, colon)) failing = call;
  }
  if (failing == kCalls || colon == std::string_view::npos) std::abort();  // a misspelt fault
  first = std::atol(fault + colon + 1);
  goes_on = text.back() == '+';
  halves = text.back() == '~';
}

void WriteCounts() {
  is_counting = false;
  const char* const path = std::getenv("MINDAHL_FAULT_COUNTS");
  if (path == nullptr) return;
  const long file = ::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  char line[64];
  for (const CallRow& row : calls) {
    const int size =
        std::snprintf(line, sizeof line, "%s %ld\n", row.name.data(), row.count.load());
    if (::syscall(SYS_write, file, line, static_cast<size_t>(size)) != size) std::abort();
  }
  ::syscall(SYS_close, file);
}

template <class Function>
Function Next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

int (*real_main)(int, char**, char**) = nullptr;

int CountingMain(int argc, char** argv, char** environment) {
  ::unsetenv("LD_PRELOAD");
  ReadFault();
  std::atexit(&WriteCounts);
  is_counting = true;
  return real_main(argc, argv, environment);
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(),
                      void (*fini)(), void (*loader_fini)(), void* stack_end) {
  real_main = main;
  using Start =
      int (*)(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  return Next<Start>("__libc_start_main")(&CountingMain, argc, argv, init, fini, loader_fini,
                                          stack_end);
}

ssize_t write(int file, const void* bytes, size_t size) {
  if (file != STDERR_FILENO) {
    if (Fails(kWrite)) return -1;
    if (IsHalved(kWrite)) size /= 2;
  }
  return ::syscall(SYS_write, file, bytes, size);
}

ssize_t writev(int file, const iovec* pieces, int count) {
  if (file != STDERR_FILENO && Fails(kWrite)) return -1;
  return ::syscall(SYS_writev, file, pieces, count);
}

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = TakesMode(flags) ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  if (Fails(kOpen)) return -1;
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = TakesMode(flags) ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  return open(path, flags, mode);
}

FILE* fopen(const char* path, const char* mode) {
  if (Fails(kOpen)) return nullptr;
  return Next<FILE* (*)(const char*, const char*)>("fopen")(path, mode);
}

FILE* fopen64(const char* path, const char* mode) { return fopen(path, mode); }

int rename(const char* from, const char* to) {
  if (Fails(kRename)) return -1;
  return static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

int fsync(int file) {
  if (Fails(kSync)) return -1;
  return static_cast<int>(::syscall(SYS_fsync, file));
}

int fdatasync(int file) {
  if (Fails(kSync)) return -1;
  return static_cast<int>(::syscall(SYS_fdatasync, file));
}

int ftruncate(int file, off_t size) {
  if (Fails(kTruncate)) return -1;
  return static_cast<int>(::syscall(SYS_ftruncate, file, size));
}

int ftruncate64(int file, off_t size) { return ftruncate(file, size); }

int close(int file) {
  const bool fails = Fails(kClose);
  const auto status = static_cast<int>(::syscall(SYS_close, file));
  if (fails) errno = EIO;  // which close() may say of a file that it has closed
  return fails ? -1 : status;
}

int mkdir(const char* path, mode_t mode) {
  if (Fails(kDirectory)) return -1;
  return static_cast<int>(::syscall(SYS_mkdirat, AT_FDCWD, path, mode));
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                   void* argument) {
  if (Fails(kThread)) return EAGAIN;
  return Next<decltype(&pthread_create)>("pthread_create")(thread, attributes, start, argument);
}

int system(const char* command) {
  if (Fails(kSystem)) return -1;
  return Next<decltype(&system)>("system")(command);
}

void* malloc(size_t size) { return Fails(kMalloc) ? nullptr : __libc_malloc(size); }
void* calloc(size_t count, size_t size) {
  return Fails(kMalloc) ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* memory, size_t size) {
  return Fails(kMalloc) ? nullptr : __libc_realloc(memory, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  return Fails(kMalloc) ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, size_t alignment, size_t size) {
  if (Fails(kMalloc)) return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}
