#include "core/record/tester_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace stickslip::record {
namespace {

analysis::Characterisation example() {
  analysis::Characterisation example;
  example.coupling = {125.6637061, 0.02201234, Eigen::Matrix2d::Zero()};
  example.coupling.covariance << 1e-4, -2e-7, -2e-7, 1e-8;
  example.ring_downs = 3;
  example.chi_squared = 4.5;
  example.freedom = 4;
  return example;
}

TEST(TesterFile, IsReadBackAsWritten) {
  const auto read =
      parse_tester(tester_text(example(), "2026-11-21T12:00:00.000000000+00:00"), "tester.toml");
  ASSERT_TRUE(read) << read.error().message;
  const auto& written = example().coupling;
  EXPECT_NEAR(read->omega, written.omega, 1e-7);  // ten digits
  EXPECT_NEAR(read->gamma_over_2omega, written.gamma_over_2omega, 1e-11);
  for (Eigen::Index i = 0; i < 4; ++i) {  // six digits
    EXPECT_NEAR(read->covariance(i), written.covariance(i), 3e-6 * std::abs(written.covariance(i)));
  }
}

TEST(TesterFile, NamesWhatIsWrong) {
  const auto message_of = [](std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    const auto read = parse_tester(text, "tester.toml");
    return read ? std::string{} : read.error().message;
  };
  const std::string text = tester_text(example(), "");
  EXPECT_NE(message_of(text, "correlation = -0.2", "correlation = -1.2").find("correlation"),
            std::string::npos);
  EXPECT_NE(message_of(text, "gamma_over_2omega = ", "gamma = ").find("gamma"), std::string::npos);
  EXPECT_NE(message_of(text, "rad/s", "kg").find("omega"), std::string::npos);
  EXPECT_FALSE(load_tester("/nonexistent/tester.toml"));
}

}  // namespace
}  // namespace stickslip::record
