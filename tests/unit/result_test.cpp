#include "core/base/result.hpp"

#include <gtest/gtest.h>

#include "core/base/contract.hpp"

namespace stickslip::test {
namespace {

base::Result<double> refuse() { return base::usage_error("rate {} Hz", 0); }
base::Result<double> fail() { return base::failure("disk {}", "full"); }

TEST(Result, UsageErrorEndsAProgramWithStatus2) {
  const auto result = refuse();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "rate 0 Hz");
  EXPECT_EQ(result.error().exit_status(), 2);
}

TEST(Result, FailureEndsAProgramWithStatus1) {
  const auto result = fail();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "disk full");
  EXPECT_EQ(result.error().exit_status(), 1);
}

TEST(ContractDeathTest, BrokenContractStopsTheProgramWithThePlace) {
  EXPECT_DEATH(STICKSLIP_EXPECTS(1 + 1 == 3), "contract broken: 1 \\+ 1 == 3 at .*result_test.cpp");
}

TEST(Contract, KeptContractCostsNothing) {
  int evaluations = 0;
  STICKSLIP_EXPECTS(++evaluations == 1);
  EXPECT_EQ(evaluations, 1);
}

}  // namespace
}  // namespace stickslip::test
