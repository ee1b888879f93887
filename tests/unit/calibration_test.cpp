#include "core/daq/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace stickslip::test {
namespace {

using daq::BoardInfo;
using daq::Calibration;
using daq::LoadCell;
using daq::RawQuantity;

/// 16 bits over ±10 V, as comedi_test's polynomial is.
BoardInfo board_16_bit() {
  BoardInfo board;
  board.quantity = RawQuantity::kCounts;
  board.maxdata = 65535;
  board.polynomial = {-10.0, 20.0 / 65535.0};
  return board;
}

BoardInfo imported(RawQuantity quantity) {
  BoardInfo board;
  board.quantity = quantity;
  return board;
}

constexpr LoadCell kCell{4.0, 0.5};  // N/V, V: exact in binary
constexpr double kLoad_N = 16.0;

TEST(Calibration, RailsAreTheEndsOfTheRange) {
  const Calibration calibration(board_16_bit(), kCell, kLoad_N);
  EXPECT_EQ(calibration.volts(0.0), -10.0);
  // One rounding of 20/65535 · 65535 and one of the sum: 2 ulp(20) = 7.2e-15.
  EXPECT_NEAR(calibration.volts(65535.0), 10.0, 7.2e-15);
}

// 0 V lies between two codes: 32767.5.
TEST(Calibration, ZeroVoltsIsHalfwayBetweenTheMiddleCodes) {
  const Calibration calibration(board_16_bit(), kCell, kLoad_N);
  const double half_step_V = 10.0 / 65535.0;
  EXPECT_NEAR(calibration.volts(32767.0), -half_step_V, 4e-15);
  EXPECT_NEAR(calibration.volts(32768.0), half_step_V, 4e-15);
}

// (V − 0.5 V) · 4 N/V over 16 N, all exact: 2.5 V → 8 N → 0.5.
TEST(Calibration, VoltsBecomeNewtonsBecomeACoefficient) {
  const Calibration calibration(imported(RawQuantity::kVolts), kCell, kLoad_N);
  EXPECT_EQ(calibration.volts(2.5), 2.5);
  EXPECT_EQ(calibration.force_N(2.5), 8.0);
  EXPECT_EQ(calibration.coefficient(2.5), 0.5);
}

TEST(Calibration, ImportedForceIgnoresTheLoadCell) {
  const Calibration calibration(imported(RawQuantity::kForce_N), kCell, kLoad_N);
  EXPECT_EQ(calibration.force_N(8.0), 8.0);
  EXPECT_EQ(calibration.coefficient(8.0), 0.5);
}

// The load is no power of two, so a round trip through newtons would change the last bits.
TEST(Calibration, ImportedCoefficientIsKeptToTheLastBit) {
  const Calibration calibration(imported(RawQuantity::kCoefficient), kCell, 22.859);
  for (const double coefficient : {0.1, 0.29573, 0.40732, 1.0 / 3.0}) {
    EXPECT_EQ(calibration.coefficient(coefficient), coefficient);
  }
  EXPECT_EQ(calibration.force_N(0.5), 0.5 * 22.859);
}

// 1 + 2x + 3x² at x = raw − 10 = 2: 17, exact.
TEST(Calibration, PolynomialIsExpandedAroundItsOrigin) {
  BoardInfo board = board_16_bit();
  board.polynomial = {1.0, 2.0, 3.0};
  board.expansion_origin = 10.0;
  const Calibration calibration(board, kCell, kLoad_N);
  EXPECT_EQ(calibration.volts(12.0), 17.0);
}

// A load cell wired the other way round has a negative gain.
TEST(Calibration, NegativeGainTurnsTheSign) {
  const Calibration calibration(imported(RawQuantity::kVolts), {-4.0, 0.0}, kLoad_N);
  EXPECT_EQ(calibration.force_N(-2.0), 8.0);
}

// Tolerance: the step is the difference of two coefficients near 0.125 with some ulp(0.125) each.
TEST(Calibration, StepIsOneCode) {
  const Calibration calibration(board_16_bit(), kCell, kLoad_N);
  EXPECT_NEAR(calibration.step_coefficient(), 20.0 / 65535.0 * 4.0 / 16.0, 4 * 0x1p-55);
  EXPECT_EQ(Calibration(imported(RawQuantity::kVolts), kCell, kLoad_N).step_coefficient(), 0.0);
}

TEST(Calibration, OnlyTheRailsOfAConverterSaturate) {
  const Calibration counts(board_16_bit(), kCell, kLoad_N);
  EXPECT_TRUE(counts.saturated(0.0));
  EXPECT_FALSE(counts.saturated(1.0));
  EXPECT_FALSE(counts.saturated(65534.0));
  EXPECT_TRUE(counts.saturated(65535.0));
  EXPECT_FALSE(Calibration(imported(RawQuantity::kForce_N), kCell, kLoad_N).saturated(0.0));
}

TEST(Calibration, ImpossibleConstantsAreRefused) {
  const double infinity = std::numeric_limits<double>::infinity();
  const BoardInfo board = board_16_bit();
  for (const double load_N : {0.0, -1.0, infinity, std::nan("")}) {
    EXPECT_THROW(Calibration(board, kCell, load_N), std::invalid_argument) << load_N;
  }
  for (const double gain_N_per_V : {0.0, infinity, std::nan("")}) {
    EXPECT_THROW(Calibration(board, {gain_N_per_V, 0.0}, kLoad_N), std::invalid_argument) << gain_N_per_V;
  }
  EXPECT_THROW(Calibration(board, {1.0, std::nan("")}, kLoad_N), std::invalid_argument);
}

}  // namespace
}  // namespace stickslip::test
