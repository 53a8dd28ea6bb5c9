# Every package comes from the system; nothing is downloaded. CONTRIBUTING.md says why each is here.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres 2.1 REQUIRED)
find_package(fmt 9 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(Threads REQUIRED)
find_package(ZLIB 1.2 REQUIRED)
find_package(Iconv REQUIRED)

if(MINDAHL_BUILD_PROGRAM)
  # CLI11 is header-only and Debian ships its package config.
  find_package(CLI11 2.1 REQUIRED)

  # toml++ is used by its headers alone.
  find_path(TOMLPLUSPLUS_INCLUDE_DIR toml++/toml.h REQUIRED)
  add_library(tomlplusplus::headers INTERFACE IMPORTED)
  target_include_directories(tomlplusplus::headers INTERFACE ${TOMLPLUSPLUS_INCLUDE_DIR})
endif()
