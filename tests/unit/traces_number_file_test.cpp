// Files of MATLAB and HDF5 as traces: which of their variables are columns, with which values, and that no
// damage of a file reaches this process.

#include <fmt/format.h>
#include <hdf5.h>
#include <matio.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/base/regular_file.hpp"
#include "core/base/sanitized.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/hdf.hpp"
#include "tests/support/bit_flips.hpp"
#include "tests/unit/traces_sample.hpp"

namespace stickslip::traces {
namespace {

using testing::HasSubstr;

/// Each damaged file has a child process of its own, which sanitizers make slow to start.
constexpr int kDamagedFiles = base::kSanitized ? 30 : 150;
constexpr std::size_t kRows = 200;  // 2 s: no other unit of time is possible.
constexpr double kRate_Hz = 100.0;

/// Small whole numbers, which each type holds.
std::vector<double> forces(std::size_t count = kRows) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<double>(1 + i % 7));
  return values;
}

std::vector<double> times(double rate_Hz = kRate_Hz) {
  std::vector<double> values;
  for (std::size_t i = 0; i < kRows; ++i) values.push_back(static_cast<double>(i) / rate_Hz);
  return values;
}

template <typename Stored>
std::vector<Stored> as(const std::vector<double>& values) {
  std::vector<Stored> stored;
  for (const double value : values) stored.push_back(static_cast<Stored>(value));
  return stored;
}

template <typename Stored>
constexpr std::pair<matio_classes, matio_types> kKind{};
template <>
constexpr std::pair<matio_classes, matio_types> kKind<double>{MAT_C_DOUBLE, MAT_T_DOUBLE};
template <>
constexpr std::pair<matio_classes, matio_types> kKind<float>{MAT_C_SINGLE, MAT_T_SINGLE};
template <>
constexpr std::pair<matio_classes, matio_types> kKind<std::int16_t>{MAT_C_INT16, MAT_T_INT16};
template <>
constexpr std::pair<matio_classes, matio_types> kKind<std::int64_t>{MAT_C_INT64, MAT_T_INT64};
template <>
constexpr std::pair<matio_classes, matio_types> kKind<std::uint8_t>{MAT_C_UINT8, MAT_T_UINT8};

/// \param values  column by column.
template <typename Stored>
matvar_t* matrix(const char* name, const std::vector<Stored>& values, std::size_t rows, int flags = 0) {
  std::array<std::size_t, 2> axes{rows, values.size() / rows};
  std::vector<Stored> own = values;
  return Mat_VarCreate(name, kKind<Stored>.first, kKind<Stored>.second, 2, axes.data(), own.data(), flags);
}

template <typename Stored>
matvar_t* column(const char* name, const std::vector<Stored>& values) {
  return matrix(name, values, values.size());
}

matvar_t* structure(const char* name, const std::vector<matvar_t*>& fields) {
  std::vector<const char*> names;
  for (const matvar_t* field : fields) names.push_back(field->name);
  const std::array<std::size_t, 2> axes{1, 1};
  matvar_t* variable = Mat_VarCreateStruct(name, 2, const_cast<std::size_t*>(axes.data()), names.data(),
                                           static_cast<unsigned>(names.size()));
  for (matvar_t* field : fields) Mat_VarSetStructFieldByName(variable, field->name, 0, field);
  return variable;
}

/// Of the two, one behind the other.
std::vector<double> joined(std::vector<double> first, const std::vector<double>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

class NumberFiles : public Traces {
 protected:
  NumberFiles() {
    record::prepare_hdf5();  // Before libmatio and these tests use it.
    request_.path = folder_ / "trace.mat";
  }

  void write(mat_ft version, const std::vector<matvar_t*>& variables,
             matio_compression compression = MAT_COMPRESSION_NONE) const {
    std::filesystem::remove(request_.path);
    mat_t* file = Mat_CreateVer(request_.path.c_str(), nullptr, version);
    ASSERT_NE(file, nullptr);
    for (matvar_t* variable : variables) {
      EXPECT_EQ(Mat_VarWrite(file, variable, compression), 0) << variable->name;
      Mat_VarFree(variable);
    }
    Mat_Close(file);
  }

  /// Imports the column; expects one record with these values at kRate_Hz.
  void expect(const std::string& column, const std::vector<double>& values) {
    request_.column = column;
    const auto imported = import_trace(request_);
    ASSERT_TRUE(imported) << column << ": " << imported.error().message;
    report_ = imported->report;
    ASSERT_EQ(imported->tests.size(), 1U) << column;
    EXPECT_EQ(test::in_memory(imported->tests.front()).raw, values) << column;
    EXPECT_NEAR(imported->tests.front().record.header.board.scan_rate_granted_Hz, kRate_Hz, 1e-3) << column;
    EXPECT_EQ(imported->tests.front().record.header.process.source_reading, report_);
  }

  void expect_error(const std::string& column, const std::string& reason) {
    request_.column = column;
    const auto imported = import_trace(request_);
    ASSERT_FALSE(imported) << column << imported->report;
    EXPECT_EQ(imported.error().exit_status(), 2);
    EXPECT_THAT(imported.error().message, HasSubstr(reason));
    EXPECT_THAT(imported.error().message, HasSubstr(request_.path));
    EXPECT_EQ(imported.error().message.find('\n'), std::string::npos);
  }
};

TEST_F(NumberFiles, VectorsOfEachVersionOfMatlabAreColumns) {
  for (const auto& [version, name] : {std::pair{MAT_FT_MAT4, "MATLAB 4"}, std::pair{MAT_FT_MAT5, "MATLAB 5"},
                                      std::pair{MAT_FT_MAT73, "MATLAB 7.3"}}) {
    for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
      write(version,
            {column("t", times()), column("F", forces()), matrix("across", forces(), 1),
             column("single", as<float>(forces())), column("int16", as<std::int16_t>(forces())),
             column("byte", as<std::uint8_t>(forces())), matrix("M", joined(times(), forces()), kRows)},
            compression);
      for (const char* variable : {"F", "across", "single", "int16", "byte", "M(:,2)"})
        expect(variable, forces());
      expect_error("F(:,2)", "no column \"F(:,2)\"");
      expect("F", forces());
      EXPECT_THAT(report_, HasSubstr(fmt::format("recognised: {}, variable F\n", name)));
      request_.time_column = "M(:,1)";
      request_.time_unit = "s";
      expect("M(:,2)", forces());
      request_.time_column.clear();
      request_.time_unit.clear();
    }
  }
}

TEST_F(NumberFiles, WideMatricesHaveTheirChannelsInRows) {
  std::vector<double> wide;  // Column by column: a time, a force.
  for (std::size_t i = 0; i < kRows; ++i) wide.insert(wide.end(), {times()[i], forces()[i]});
  for (const auto version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    write(version, {column("t", times()), matrix("W", wide, 2)});
    expect("W(2,:)", forces());
  }
}

TEST_F(NumberFiles, FieldsOfAStructAreColumnsAndHaveTheTimeBesideThem) {
  const std::vector<double> slow = times(kRate_Hz / 2.0);
  for (const auto version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    write(version, {column("t", slow), structure("other", {column("Data", forces()), column("Time", slow)}),
                    structure("run", {column("Data", forces()), column("Time", times()),
                                      structure("deep", {column("F", forces())})})});
    expect("run.Data", forces());
    EXPECT_THAT(report_, HasSubstr("variable run.Data\n"));
    EXPECT_THAT(report_, HasSubstr("\"run.Time\""));
    expect("run.deep.F", forces());
    EXPECT_THAT(report_, HasSubstr("\"run.Time\""));
    expect("F", forces());
    expect_error("Data", "both called \"Data\": give the number");
  }
}

TEST_F(NumberFiles, WhatIsNoVectorOfNumbersIsNamed) {
  for (const auto version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    std::array<std::size_t, 2> axes{kRows, 1};
    std::vector<double> real = forces();
    mat_complex_split_t both{real.data(), real.data()};
    matvar_t* complex = Mat_VarCreate("z", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, axes.data(), &both, MAT_F_COMPLEX);
    std::array<std::size_t, 2> one_of_two{1, 2};
    std::array<matvar_t*, 2> cells{column("", forces()), column("", forces())};
    matvar_t* cell = Mat_VarCreate("c", MAT_C_CELL, MAT_T_CELL, 2, one_of_two.data(), cells.data(), 0);
    std::array<std::size_t, 2> letters{1, 1};
    char unit = 'N';
    matvar_t* text = Mat_VarCreate("units", MAT_C_CHAR, MAT_T_UTF8, 2, letters.data(), &unit, 0);
    write(version, {column("F", forces()), cell, column("rate", std::vector<double>{kRate_Hz}),
                    column("short", forces(3)), column("t", times()), text, complex});
    expect("F", forces());
    expect_error("z", "\"z\" is complex; vectors of numbers are 1 \"F\", 2 \"short\", 3 \"t\"");
    expect_error("c", "\"c\" is a cell array");
    expect_error("units", "\"units\" is text");
    expect_error("rate", "\"rate\" is one number");
    expect_error("none", "there is no column \"none\"; vectors of numbers are 1 \"F\"");
    expect_error("", "give --column NAME; there are 1 \"F\", 2 \"short\", 3 \"t\": stickslip import ");
    // Nobody reads a time of another length.
    expect_error("short", "no column is a time by its name");
    request_.time_column = "t";
    expect_error("short", "\"t\" has 200 values, \"short\" 3: choose columns of one length");
    request_.time_column.clear();
    const auto inspected = inspect(request_);
    ASSERT_TRUE(inspected) << inspected.error().message;
    EXPECT_THAT(*inspected, HasSubstr("of another length than F (200): short (3)\n"));
    EXPECT_THAT(*inspected,
                HasSubstr("no columns: c is a cell array, rate is one number, units is text, z is"));
    request_.dialect.skip = 1;
    expect_error("F", "leave out --encoding, --separator, --decimal and --skip");
    request_.dialect.skip = 0;
  }
}

TEST_F(NumberFiles, HolesAreGapsAndTimesMayBeCoarse) {
  std::vector<double> holed = forces();
  holed[3] = std::numeric_limits<double>::quiet_NaN();
  holed[9] = std::numeric_limits<double>::infinity();
  std::vector<double> milliseconds = times();
  for (double& time : milliseconds) time = std::round(1e3 * time);
  write(MAT_FT_MAT5, {column("millis", milliseconds), column("F", holed)});
  request_.column = "F";
  const auto imported = import_trace(request_);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(test::in_memory(imported->tests.front()).raw.size(), kRows - 2);
  EXPECT_EQ(imported->tests.front().record.gaps.size(), 2U);
  std::vector<double> lacking = times();
  lacking[5] = std::numeric_limits<double>::quiet_NaN();
  write(MAT_FT_MAT5, {column("t", lacking), column("F", forces())});
  expect_error("F", ":6: \"t\" has no time beside the value 6: give --time-column none and --rate HZ");
}

TEST_F(NumberFiles, NanosecondsSince1970KeepTheirRate) {
  std::vector<std::int64_t> nanoseconds;
  for (std::size_t i = 0; i < kRows; ++i)
    nanoseconds.push_back(1'764'000'000'000'000'000 + static_cast<std::int64_t>(i) * 10'000'000);
  write(MAT_FT_MAT5, {column("time_ns", nanoseconds), column("F", forces())});
  request_.time_column = "time_ns";
  request_.time_unit = "ns";
  expect("F", forces());
}

/// An HDF5 file of others.
class Hdf5File {
 public:
  explicit Hdf5File(const std::string& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;
  ~Hdf5File() { H5Fclose(file_); }

  void group(const char* name) const {
    H5Gclose(H5Gcreate2(file_, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  }

  void write(const char* name, const std::vector<double>& values, hid_t stored,
             std::vector<hsize_t> axes = {}, const char* unit = nullptr) const {
    if (axes.empty()) axes = {values.size()};
    const hid_t space = H5Screate_simple(static_cast<int>(axes.size()), axes.data(), nullptr);
    const hid_t set = H5Dcreate2(file_, name, stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    if (unit != nullptr) {
      const hid_t text = H5Tcopy(H5T_C_S1);
      H5Tset_size(text, std::string{unit}.size());
      const hid_t one = H5Screate(H5S_SCALAR);
      const hid_t attribute = H5Acreate2(set, "units", text, one, H5P_DEFAULT, H5P_DEFAULT);
      H5Awrite(attribute, text, unit);
      H5Aclose(attribute);
      H5Sclose(one);
      H5Tclose(text);
    }
    H5Dclose(set);
    H5Sclose(space);
  }

  /// An attribute of a dataset, 0.001.
  void attach(const char* name, const char* attribute) const {
    const double value = 0.001;
    const hid_t one = H5Screate(H5S_SCALAR);
    const hid_t own = H5Acreate_by_name(file_, name, attribute, H5T_NATIVE_DOUBLE, one, H5P_DEFAULT,
                                        H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(own, H5T_NATIVE_DOUBLE, &value);
    H5Aclose(own);
    H5Sclose(one);
  }

  /// Complex numbers as h5py writes them.
  void write_complex(const char* name) const {
    const hid_t type = H5Tcreate(H5T_COMPOUND, 2 * sizeof(double));
    H5Tinsert(type, "r", 0, H5T_NATIVE_DOUBLE);
    H5Tinsert(type, "i", sizeof(double), H5T_NATIVE_DOUBLE);
    const hsize_t count = kRows;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    H5Dclose(H5Dcreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
    H5Tclose(type);
  }

  /// Members time and force.
  void write_table(const char* name) const {
    const hid_t type = H5Tcreate(H5T_COMPOUND, 2 * sizeof(double));
    H5Tinsert(type, "time", 0, H5T_NATIVE_DOUBLE);
    H5Tinsert(type, "force", sizeof(double), H5T_NATIVE_DOUBLE);
    std::vector<double> rows;
    for (std::size_t i = 0; i < kRows; ++i) rows.insert(rows.end(), {times()[i], forces()[i]});
    const hsize_t count = kRows;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t set = H5Dcreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data());
    H5Dclose(set);
    H5Sclose(space);
    H5Tclose(type);
  }

  /// A dataset whose bytes stand in another file.
  void write_elsewhere(const char* name) const {
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(creation, "/etc/passwd", 0, kRows);
    const hsize_t count = kRows;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    H5Dclose(H5Dcreate2(file_, name, H5T_NATIVE_UINT8, space, H5P_DEFAULT, creation, H5P_DEFAULT));
    H5Sclose(space);
    H5Pclose(creation);
    H5Lcreate_external("/etc/x.h5", "/a", file_, "link", H5P_DEFAULT, H5P_DEFAULT);
  }

 private:
  hid_t file_;
};

TEST_F(NumberFiles, DatasetsOfHdf5AreColumns) {
  request_.path = folder_ / "trace.h5";
  std::vector<double> rows;
  for (std::size_t i = 0; i < kRows; ++i) rows.insert(rows.end(), {times()[i], forces()[i]});
  {
    const Hdf5File file{request_.path};
    for (const char* group : {"/run1", "/run2"}) file.group(group);
    file.write("/run1/time", times(kRate_Hz / 2.0), H5T_NATIVE_DOUBLE);
    file.write("/run1/force", forces(), H5T_NATIVE_DOUBLE);
    file.write("/run2/time", times(), H5T_IEEE_F32BE, {}, "s");
    file.write("/run2/force", forces(), H5T_STD_I16BE);
    file.write("/run2/matrix", rows, H5T_NATIVE_FLOAT, {kRows, 2});
    file.write("/run2/deep", forces(), H5T_NATIVE_UINT8, {1, kRows, 1});
    file.write("/cube", std::vector<double>(24), H5T_NATIVE_DOUBLE, {2, 3, 4});
    file.write_table("/run2/table");
    file.write_elsewhere("/elsewhere");
  }
  for (const char* name :
       {"/run2/force", "run2/force", "/run2/matrix(:,2)", "/run2/deep", "/run2/table.force"})
    expect(name, forces());
  EXPECT_THAT(report_, HasSubstr("recognised: HDF5, dataset /run2/table.force\n"));
  request_.time_column = "/run2/matrix(:,1)";
  expect("/run1/force", forces());
  expect_error("/cube", "\"/cube\" has 3 dimensions");
  expect_error("/elsewhere", "\"/elsewhere\" lies in another file");
  expect_error("", "give --dataset NAME; there are 1 \"/run1/force\"");
}

TEST_F(NumberFiles, AMemberIsReadFromItsCompoundWhateverElseHasItsName) {
  request_.path = folder_ / "trace.h5";
  {
    const Hdf5File file{request_.path};
    file.write_table("/table");
    file.write_elsewhere("/table.force");
    file.write("/time.force", times(), H5T_NATIVE_DOUBLE);
  }
  request_.time_column = "/table.time";
  expect("/table.force", forces());
}

TEST_F(NumberFiles, TheUnitOfADatasetIsThatOfItsAttribute) {
  request_.path = folder_ / "trace.h5";
  {
    const Hdf5File file{request_.path};
    file.write("/force", forces(), H5T_NATIVE_DOUBLE, {}, "mN");
    file.write("/time", times(), H5T_NATIVE_DOUBLE, {}, "s");
  }
  request_.unit = "N";
  expect_error("/force", "is in mN, --unit says N: give --unit mN");
  request_.unit.clear();
  std::vector<double> newtons = forces();
  for (double& force : newtons) force *= 1e-3;
  expect("/force", newtons);
}

TEST_F(NumberFiles, ScaledAndComplexDatasetsAreRefusedWithTheReason) {
  request_.path = folder_ / "trace.h5";
  {
    const Hdf5File file{request_.path};
    file.write("/packed", forces(), H5T_STD_I16LE, {}, "N");
    file.attach("/packed", "scale_factor");
    file.write("/shifted", forces(), H5T_STD_I16LE, {}, "N");
    file.attach("/shifted", "add_offset");
    file.write_complex("/z");
    file.write("/time", times(), H5T_NATIVE_DOUBLE);
  }
  expect_error("/packed", "\"/packed\" is scaled by scale_factor");
  expect_error("/shifted", "\"/shifted\" is scaled by add_offset");
  for (const std::string name : {"/z", "z"}) expect_error(name, "\"" + name + "\" is complex");
}

TEST_F(NumberFiles, PointsInANameOfHdf5AreNoGroups) {
  request_.path = folder_ / "trace.h5";
  {
    const Hdf5File file{request_.path};
    for (const char* group : {"/run1", "/run2"}) file.group(group);
    file.write("/run1/time", times(kRate_Hz / 2.0), H5T_NATIVE_DOUBLE);
    file.write("/run1/force.raw", forces(), H5T_NATIVE_DOUBLE);
    file.write("/run2/time", times(), H5T_NATIVE_DOUBLE);
    file.write("/run2/force.raw", forces(), H5T_NATIVE_DOUBLE);
  }
  expect("/run2/force.raw", forces());
  EXPECT_THAT(report_, HasSubstr("/run2/time"));
}

TEST_F(NumberFiles, ARecordNeedsNoImport) {
  request_.path = folder_ / "record.h5";
  ASSERT_TRUE(record::publish_record(test::sample_record(), request_.path));
  expect_error("force", "is a record of stickslip already, which needs no import: stickslip analyze ");
}

TEST_F(NumberFiles, OfAFileThatIsCutShortNoValueIsTaken) {
  for (const auto version : {MAT_FT_MAT4, MAT_FT_MAT5, MAT_FT_MAT73}) {
    for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
      write(version, {column("t", times()), column("F", forces())}, compression);
      const std::string whole = base::read_text(request_.path).value();
      const std::size_t step = 1 + whole.size() / kDamagedFiles;
      for (std::size_t size = 0; size < whole.size(); size += step) {
        test::write_content(request_.path, whole.substr(0, size));
        request_.column = "F";
        const auto imported = import_trace(request_);
        EXPECT_FALSE(imported) << version << ": " << size << " of " << whole.size()
                               << " bytes: " << imported->report;
      }
    }
  }
}

TEST_F(NumberFiles, ABitTheOtherWayInACompressedVariableChangesNoValue) {
  write(MAT_FT_MAT5, {column("t", times()), column("F", forces())}, MAT_COMPRESSION_ZLIB);
  const std::string whole = base::read_text(request_.path).value();
  // Nothing but the streams stands behind the header and the first tag.
  constexpr std::size_t kBefore = 128 + 8;
  request_.column = "F";
  int refused = 0;
  for (std::size_t byte = kBefore; byte < whole.size(); byte += 7) {
    test::write_flipped(request_.path, whole, 8 * byte + byte % 8);
    // A few bits fill the last byte of a stream, before its checksum.
    const auto imported = import_trace(request_);
    EXPECT_TRUE(!imported || test::in_memory(imported->tests.front()).raw == forces()) << byte;
    refused += imported ? 0 : 1;
  }
  EXPECT_GT(refused, 50);
}

TEST_F(NumberFiles, ABitTheOtherWayIsAnErrorOrAResultAndHarmsNobody) {
  for (const auto version : {MAT_FT_MAT4, MAT_FT_MAT5, MAT_FT_MAT73}) {
    std::vector<matvar_t*> variables{column("t", times()), column("F", forces())};
    if (version != MAT_FT_MAT4) variables.push_back(structure("run", {column("F", forces())}));
    write(version, variables, MAT_COMPRESSION_ZLIB);
    const std::string whole = base::read_text(request_.path).value();
    std::uint64_t state = 1;  // Of a linear congruence [Knuth].
    for (int i = 0; i < kDamagedFiles; ++i) {
      state = state * 6'364'136'223'846'793'005U + 1'442'695'040'888'963'407U;
      test::write_flipped(request_.path, whole, (state >> 32U) % (8 * whole.size()));
      request_.column = "F";
      const auto imported = import_trace(request_);
      if (!imported) {
        EXPECT_EQ(imported.error().message.find('\n'), std::string::npos) << imported.error().message;
        continue;
      }
      EXPECT_LE(test::in_memory(imported->tests.front()).raw.size(), kRows);
    }
  }
}

}  // namespace
}  // namespace stickslip::traces
