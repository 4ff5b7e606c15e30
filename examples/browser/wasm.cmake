# Toolchain: clang-19 for WebAssembly with Debian's libc++ and wasi-libc. No exceptions, no threads.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_CXX_COMPILER clang++-19)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_AR llvm-ar-19)
set(CMAKE_RANLIB llvm-ranlib-19)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_FIND_PACKAGE_PREFER_CONFIG ON)
# Boost 1.74 names std::unary_function, which C++17 took away, and takes locks unless it is told that there is one thread.
string(JOIN " " CMAKE_CXX_FLAGS_INIT
  -fno-exceptions -fno-rtti
  -D_LIBCPP_ENABLE_CXX17_REMOVED_UNARY_BINARY_FUNCTION -DBOOST_DISABLE_THREADS -DBOOST_SP_DISABLE_THREADS
  -D_WASI_EMULATED_PROCESS_CLOCKS)
