# Names that work on Debian 12; `./dev deps` installs the packages.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C HL)
find_package(OpenSSL 3.0 REQUIRED COMPONENTS Crypto)
# libcsv comes with neither a CMake nor a pkg-config file.
find_library(STICKSLIP_CSV_LIBRARY csv REQUIRED)
find_package(spdlog REQUIRED)
find_package(fmt REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(SUNDIALS REQUIRED
  COMPONENTS cvode nvecserial sunmatrixdense sunlinsoldense sunnonlinsolfixedpoint)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tl-expected REQUIRED)
pkg_check_modules(comedi REQUIRED IMPORTED_TARGET comedilib)
pkg_check_modules(systemd REQUIRED IMPORTED_TARGET libsystemd)
