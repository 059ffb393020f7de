#include "drivers/web_socket.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>

namespace touchstone::hil {

namespace asio = boost::asio;
namespace beast = boost::beast;

class WebSocket::Link {
 public:
  Link(const std::string& called, const std::string& host, int port, double timeout_s)
      : place_(fmt::format("{} at ws://{}:{}", called, host, port)), stream_(io_) {
    const double until = clock_.now_s() + timeout_s;
    asio::ip::tcp::resolver resolver(io_);
    beast::error_code error;
    const auto found = resolver.resolve(host, std::to_string(port), error);
    if (error) throw DeviceError(DeviceStatus::absent, fmt::format("{}: {}", place_, error.message()));
    run(until, DeviceStatus::absent, [&](auto finished) {
      beast::get_lowest_layer(stream_).async_connect(
          found, [finished](beast::error_code e, const auto&) mutable { finished(e); });
    });
    beast::get_lowest_layer(stream_).socket().set_option(asio::ip::tcp::no_delay(true), error);
    local_ = beast::get_lowest_layer(stream_).socket().remote_endpoint(error).address().is_loopback();
    run(until, DeviceStatus::absent, [&](auto finished) {
      stream_.async_handshake(fmt::format("{}:{}", host, port), "/",
                              [finished](beast::error_code e) mutable { finished(e); });
    });
    stream_.text(true);
  }

  void send(const std::string& text, double deadline_s) {
    run(deadline_s, DeviceStatus::gone, [&](auto finished) {
      stream_.async_write(asio::buffer(text), [finished](beast::error_code e, std::size_t) mutable { finished(e); });
    });
  }

  const std::string& receive(double deadline_s) {
    text_.clear();
    auto buffer = asio::dynamic_buffer(text_, largest_message);
    run(deadline_s, DeviceStatus::gone, [&](auto finished) {
      stream_.async_read(buffer, [finished](beast::error_code e, std::size_t) mutable { finished(e); });
    });
    return text_;
  }

  [[nodiscard]] bool good() const noexcept { return good_; }
  [[nodiscard]] bool local() const noexcept { return local_; }

 private:
  static constexpr std::size_t largest_message = 1U << 22U;

  // One operation to its end or the deadline.
  template <class Start>
  void run(double deadline_s, DeviceStatus when_it_fails, Start start) {
    if (!good_) throw DeviceError(DeviceStatus::gone, place_ + ": the connection broke before");
    bool done = false;
    beast::error_code result;
    start([&done, &result](beast::error_code e) { done = true, result = e; });
    io_.restart();
    while (!done) {
      const double left = deadline_s - clock_.now_s();
      if (left <= 0.0) break;
      io_.run_one_for(std::chrono::microseconds(static_cast<long>(std::min(left, 3600.0) * 1e6) + 1));
    }
    if (!done) {
      good_ = false;
      beast::get_lowest_layer(stream_).close();
      io_.restart();
      io_.run();  // the operation ends with its cancellation
      throw DeviceError(DeviceStatus::timed_out, place_ + ": no answer in time");
    }
    if (result) {
      good_ = false;
      throw DeviceError(when_it_fails, fmt::format("{}: {}", place_, result.message()));
    }
  }

  std::string place_;
  MonotonicClock clock_;
  asio::io_context io_;
  beast::websocket::stream<beast::tcp_stream> stream_;
  std::string text_;
  bool good_ = true, local_ = false;
};

WebSocket::WebSocket(const std::string& called, const std::string& host, int port, double timeout_s)
    : link_(std::make_unique<Link>(called, host, port, timeout_s)) {}
WebSocket::~WebSocket() = default;
void WebSocket::send(const std::string& text, double deadline_s) { link_->send(text, deadline_s); }
const std::string& WebSocket::receive(double deadline_s) { return link_->receive(deadline_s); }
bool WebSocket::good() const noexcept { return link_->good(); }
bool WebSocket::local() const noexcept { return link_->local(); }

}  // namespace touchstone::hil
