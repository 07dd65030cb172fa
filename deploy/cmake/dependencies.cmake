# SPDX-License-Identifier: Apache-2.0
# Every dependency is a Debian 12 package; deploy/packages.txt lists them with the reason for each.
find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(tl-expected REQUIRED)
find_package(glm REQUIRED)
find_package(TBB REQUIRED)
find_package(embree 3 REQUIRED)
find_package(assimp REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(Protobuf REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(CLI11 REQUIRED)
find_package(SQLiteCpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(OpenSSL 3 REQUIRED)
find_package(GTest REQUIRED)
find_package(benchmark REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(HIREDIS REQUIRED IMPORTED_TARGET hiredis)
pkg_check_modules(EGL REQUIRED IMPORTED_TARGET egl)
pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
find_package(glfw3 REQUIRED)
find_path(ASIO_INCLUDE_DIR asio.hpp REQUIRED)
add_library(farfield_asio INTERFACE)
target_include_directories(farfield_asio SYSTEM INTERFACE ${ASIO_INCLUDE_DIR})
# Asio 1.22 uses aligned_alloc() only in files that include a standard header before it: memory taken in one way would be
# given back in the other.
target_compile_definitions(farfield_asio INTERFACE ASIO_STANDALONE ASIO_NO_DEPRECATED ASIO_DISABLE_STD_ALIGNED_ALLOC)
target_link_libraries(farfield_asio INTERFACE Threads::Threads)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # Asio 1.22 asks for the compiler's old name of coroutines.
  target_compile_definitions(farfield_asio INTERFACE ASIO_HAS_CO_AWAIT ASIO_HAS_STD_COROUTINE)
endif()
# Only the benchmark's method `video` needs these; without them it is left out.
pkg_check_modules(LIBAV IMPORTED_TARGET libavcodec libavutil)

# farfield_concurrent_malloc(PROGRAM): memory from mimalloc, in place of the C library's, which takes a tenth of a loaded network thread
# and slows down with the millions of small buffers behind it. Sanitizers bring their own.
find_package(mimalloc REQUIRED)
function(farfield_concurrent_malloc program)
  if(NOT FARFIELD_SANITIZE AND NOT FARFIELD_FUZZ)
    # Nothing refers to it by name, so the linker would leave it out.
    target_link_options(${program} PRIVATE "LINKER:--push-state,--no-as-needed,$<TARGET_FILE:mimalloc>,--pop-state")
  endif()
endfunction()
