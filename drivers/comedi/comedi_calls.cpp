#include "drivers/comedi/comedi_calls.hpp"

#include <comedilib.h>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

namespace stickslip::drivers {
namespace {

static_assert(trigger::kNone == TRIG_NONE && trigger::kNow == TRIG_NOW && trigger::kFollow == TRIG_FOLLOW &&
              trigger::kTimer == TRIG_TIMER && trigger::kCount == TRIG_COUNT);
static_assert(kWakeEndOfScan == CMDF_WAKE_EOS && kAnalogInput == COMEDI_SUBD_AI);
static_assert(subdevice_flag::kCanCommand == SDF_CMD_READ && subdevice_flag::kReadable == SDF_READABLE &&
              subdevice_flag::kSoftCalibrated == SDF_SOFT_CALIBRATED &&
              subdevice_flag::kGround == SDF_GROUND && subdevice_flag::kCommon == SDF_COMMON &&
              subdevice_flag::kDifferential == SDF_DIFF && subdevice_flag::kOther == SDF_OTHER &&
              subdevice_flag::kLargeSample == SDF_LSAMPL);
static_assert(static_cast<unsigned>(AnalogReference::kGround) == AREF_GROUND &&
              static_cast<unsigned>(AnalogReference::kCommon) == AREF_COMMON &&
              static_cast<unsigned>(AnalogReference::kDifferential) == AREF_DIFF &&
              static_cast<unsigned>(AnalogReference::kOther) == AREF_OTHER);

template <auto function>
struct Deleter {
  template <typename T>
  void operator()(T* object) const noexcept {
    function(object);
  }
};
using CalibrationPtr = std::unique_ptr<comedi_calibration_t, Deleter<::comedi_cleanup_calibration>>;
using TextPtr = std::unique_ptr<char, Deleter<::free>>;

/// −errno of the libcomedi call that just failed. Some of its functions fail without setting an error.
int failed_call() {
  const int error = ::comedi_errno();
  return error > 0 ? -error : -EIO;
}

int checked(int result) { return result < 0 ? failed_call() : result; }

ConversionPolynomial copy_of(const comedi_polynomial_t& polynomial) {
  const auto count = std::min<std::size_t>(polynomial.order + 1, std::size(polynomial.coefficients));
  return {{polynomial.coefficients, polynomial.coefficients + count}, polynomial.expansion_origin};
}

/// libcomedi's struct with room for its channel list.
struct Native {
  explicit Native(const ComediCommand& from)
      : entries{CR_PACK(from.channel, from.range, static_cast<unsigned>(from.reference)), 0} {
    if (from.second) {
      entries[1] = CR_PACK(from.second->channel, from.second->range, static_cast<unsigned>(from.reference));
    }
    command.subdev = from.subdevice;
    command.flags = from.flags;
    command.start_src = from.start_source;
    command.start_arg = from.start_argument;
    command.scan_begin_src = from.scan_begin_source;
    command.scan_begin_arg = from.scan_begin_argument;
    command.convert_src = from.convert_source;
    command.convert_arg = from.convert_argument;
    command.scan_end_src = from.scan_end_source;
    command.scan_end_arg = from.scan_end_argument;
    command.stop_src = from.stop_source;
    command.stop_arg = from.stop_argument;
    command.chanlist = entries.data();
    command.chanlist_len = from.channel_count();
  }
  Native(const Native&) = delete;
  Native& operator=(const Native&) = delete;
  ~Native() = default;

  void copy_to(ComediCommand& to) const {
    to.flags = command.flags;
    to.start_source = command.start_src;
    to.start_argument = command.start_arg;
    to.scan_begin_source = command.scan_begin_src;
    to.scan_begin_argument = command.scan_begin_arg;
    to.convert_source = command.convert_src;
    to.convert_argument = command.convert_arg;
    to.scan_end_source = command.scan_end_src;
    to.scan_end_argument = command.scan_end_arg;
    to.stop_source = command.stop_src;
    to.stop_argument = command.stop_arg;
  }

  std::array<unsigned, 2> entries;
  comedi_cmd command{};
};

class RealComediCalls final : public ComediCalls {
 public:
  RealComediCalls() = default;
  RealComediCalls(const RealComediCalls&) = delete;
  RealComediCalls& operator=(const RealComediCalls&) = delete;
  ~RealComediCalls() override { RealComediCalls::close(); }

  int open(const std::string& device) override {
    close();
    device_ = ::comedi_open(device.c_str());
    if (device_ == nullptr) return failed_call();
    file_ = ::comedi_fileno(device_);
    const int flags = ::fcntl(file_, F_GETFL);
    if (flags < 0 || ::fcntl(file_, F_SETFL, flags | O_NONBLOCK) < 0 ||
        ::fcntl(file_, F_SETFD, FD_CLOEXEC) < 0) {
      const int error = errno;
      close();
      return -error;
    }
    return 0;
  }

  void close() noexcept override {
    if (device_ != nullptr) ::comedi_close(device_);
    device_ = nullptr;
    file_ = -1;
  }

  std::vector<std::string> devices() override { return comedi_devices(); }
  BoardPlace place(const std::string& device) override { return place_of(device); }

  std::string driver_name() override { return text(::comedi_get_driver_name(device_)); }
  std::string board_name() override { return text(::comedi_get_board_name(device_)); }

  int find_analog_input() override {
    return checked(::comedi_find_subdevice_by_type(device_, COMEDI_SUBD_AI, 0));
  }

  int channel_count(unsigned subdevice) override {
    return checked(::comedi_get_n_channels(device_, subdevice));
  }

  int subdevice_count() override { return checked(::comedi_get_n_subdevices(device_)); }

  int subdevice_type(unsigned subdevice) override {
    return checked(::comedi_get_subdevice_type(device_, subdevice));
  }

  unsigned subdevice_flags(unsigned subdevice) override {
    // −1 where there is no such subdevice: then the flags would say yes to everything.
    const int flags = ::comedi_get_subdevice_flags(device_, subdevice);
    return flags == -1 ? 0U : static_cast<unsigned>(flags);
  }

  std::uint32_t maxdata(unsigned subdevice, unsigned channel) override {
    return ::comedi_get_maxdata(device_, subdevice, channel);
  }

  int range_count(unsigned subdevice, unsigned channel) override {
    return checked(::comedi_get_n_ranges(device_, subdevice, channel));
  }

  std::optional<InputRange> range(unsigned subdevice, unsigned channel, unsigned range) override {
    const comedi_range* found = ::comedi_get_range(device_, subdevice, channel, range);
    if (found == nullptr) return std::nullopt;
    return InputRange{found->min, found->max, found->unit == UNIT_volt};
  }

  std::optional<ConversionPolynomial> hard_calibration(unsigned subdevice, unsigned channel,
                                                       unsigned range) override {
    comedi_polynomial_t polynomial{};
    if (::comedi_get_hardcal_converter(device_, subdevice, channel, range, COMEDI_TO_PHYSICAL, &polynomial) <
        0) {
      return std::nullopt;
    }
    return copy_of(polynomial);
  }

  base::Result<ConversionPolynomial> soft_calibration(unsigned subdevice, unsigned channel,
                                                      unsigned range) override {
    // Neither function sets an error that could be trusted, so the messages name the file.
    const TextPtr path(::comedi_get_default_calibration_path(device_));
    if (path == nullptr) return base::failure("the board has no calibration path");
    const CalibrationPtr file(::comedi_parse_calibration_file(path.get()));
    if (file == nullptr) {
      return base::failure("{}: missing or not a calibration file; make it with comedi_soft_calibrate",
                           path.get());
    }
    comedi_polynomial_t polynomial{};
    if (::comedi_get_softcal_converter(subdevice, channel, range, COMEDI_TO_PHYSICAL, file.get(),
                                       &polynomial) < 0) {
      return base::failure(
          "{}: holds no calibration of subdevice {}, channel {}, range {}; renew it with "
          "comedi_soft_calibrate",
          path.get(), subdevice, channel, range);
    }
    return copy_of(polynomial);
  }

  int command_test(ComediCommand& command) override {
    Native native(command);
    const int result = checked(::comedi_command_test(device_, &native.command));
    native.copy_to(command);
    return result;
  }

  int command(const ComediCommand& command) override {
    Native native(command);
    return checked(::comedi_command(device_, &native.command));
  }

  int cancel(unsigned subdevice) noexcept override { return checked(::comedi_cancel(device_, subdevice)); }

  int set_buffer_size(unsigned subdevice, unsigned size) override {
    return checked(::comedi_set_buffer_size(device_, subdevice, size));
  }

  int read_one(const ComediCommand& input, std::uint32_t& code) noexcept override {
    lsampl_t value = 0;
    const int result = checked(::comedi_data_read(device_, input.subdevice, input.channel, input.range,
                                                  static_cast<unsigned>(input.reference), &value));
    code = value;
    return result;
  }

  int poll(std::chrono::milliseconds timeout) noexcept override {
    pollfd watched{file_, POLLIN, 0};
    const int result = ::poll(&watched, 1, static_cast<int>(timeout.count()));
    return result < 0 ? -errno : result;
  }

  int read(std::span<std::byte> buffer) noexcept override {
    const ssize_t result = ::read(file_, buffer.data(), buffer.size());
    return result < 0 ? -errno : static_cast<int>(result);
  }

 private:
  static std::string text(const char* name) { return name != nullptr ? name : ""; }

  comedi_t* device_ = nullptr;
  int file_ = -1;
};

}  // namespace

std::vector<std::string> comedi_devices(const std::string& folder) {
  std::vector<std::pair<int, std::string>> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator{folder, error}) {
    const std::string name = entry.path().filename();
    constexpr std::string_view kPrefix = "comedi";
    const std::string number = name.starts_with(kPrefix) ? name.substr(kPrefix.size()) : "";
    constexpr std::size_t kMostDigits = 3;
    if (number.empty() || number.size() > kMostDigits ||
        !std::all_of(number.begin(), number.end(), [](unsigned char c) { return std::isdigit(c) != 0; })) {
      continue;  // comedi0_subd1: one subdevice of a board
    }
    found.emplace_back(std::stoi(number), entry.path().string());
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> devices;
  devices.reserve(found.size());
  for (auto& [number, device] : found) devices.push_back(std::move(device));
  return devices;
}

std::unique_ptr<ComediCalls> make_comedi_calls() { return std::make_unique<RealComediCalls>(); }

}  // namespace stickslip::drivers
