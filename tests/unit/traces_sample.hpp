/// \file
/// Small traces as other programs export them.
#pragma once

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "io/traces/import.hpp"

#include "tests/support/imported_record.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::traces {

/// Imports column `F`, in coefficients, of a file with the content given.
class Traces : public testing::Test {
 protected:
  Traces() {
    request_.path = folder_ / "trace.csv";
    request_.column = "F";
    request_.unit = "coefficient";
    request_.tester.sled_mass_kg = 0.2;
  }

  base::Result<Imported> import(const std::string& content) {
    test::write_content(request_.path, content);
    return import_trace(request_);
  }

  /// Expects one record with these values, and gives it.
  record::Record expect_values(const std::string& content, const std::vector<double>& values) {
    auto imported = import(content);
    EXPECT_TRUE(imported) << content << imported.error().message;
    if (!imported) return {};
    EXPECT_EQ(imported->tests.size(), 1U) << content;
    EXPECT_EQ(test::in_memory(imported->tests.front()).raw, values) << content;
    report_ = imported->report;
    return test::in_memory(imported->tests.front());
  }

  void expect_refused(const std::string& content, const std::string& reason) {
    const auto imported = import(content);
    ASSERT_FALSE(imported) << content << imported->report;
    EXPECT_EQ(imported.error().exit_status(), 2);
    EXPECT_THAT(imported.error().message, testing::HasSubstr(reason));
    EXPECT_THAT(imported.error().message, testing::HasSubstr("trace.csv"));
    EXPECT_EQ(imported.error().message.find('\n'), std::string::npos);
  }

  test::TemporaryFolder folder_;
  ImportRequest request_;
  std::string report_;  ///< Of the last import.
};

}  // namespace stickslip::traces
