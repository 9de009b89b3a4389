// SPDX-License-Identifier: MIT
#include "seqloop/http/server.hpp"

#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <exception>
#include <thread>
#include <utility>

#include "http/connection.hpp"
#include "http/connection_threads.hpp"
#include "http/request_head.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::http {
namespace {

using namespace std::chrono_literals;

/// Said with every reply: nothing comes from elsewhere, nothing runs but our own script, and no
/// other page may look in.
constexpr std::array<std::pair<const char*, const char*>, 6> manners{
    {{"Content-Security-Policy",
      "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src "
      "'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
     {"X-Content-Type-Options", "nosniff"},
     {"Referrer-Policy", "no-referrer"},
     {"Cross-Origin-Resource-Policy", "same-origin"},
     {"Cross-Origin-Opener-Policy", "same-origin"},
     {"Cache-Control", "no-store"}}};

/// @param why without quotes, as it stands in JSON
/// @param head whether headers alone are asked for, as by HEAD
std::string refusal(int status, std::string_view why, bool head = false) {
  const std::string body = "{\"error\":\"" + std::string(why) + "\"}";
  std::string text = "HTTP/1.1 " + std::to_string(status) + " Refused\r\n";
  for (const auto& [name, value] : manners) text += std::string(name) + ": " + value + "\r\n";
  if (status == 405) text += "Allow: GET, HEAD, POST\r\n";
  text += "Content-Type: application/json\r\nConnection: close\r\nContent-Length: " +
          std::to_string(body.size()) + "\r\n\r\n";
  return head ? text : text + body;
}

Rules rules_for(const Address& address, std::string token) {
  Rules rules{{"localhost", "127.0.0.1", "::1", address.host}, false, std::move(token)};
  if (is_loopback(address.host)) return rules;
  // Whoever reaches it by an address was not led here by a foreign name.
  rules.any_ip = true;
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) == 0 && name.front() != '\0') {
    rules.hosts.emplace_back(name.data());
    rules.hosts.push_back(rules.hosts.back() + ".local");
  }
  return rules;
}

}  // namespace

class Server::Impl : private httplib::Server {
 public:
  Impl(const Address& address, std::string token, Site& site, Priority priority)
      : address_(address), rules_(rules_for(address, std::move(token))), site_(&site) {
    const bool low = priority == Priority::low;
    new_task_queue = [low] { return new ConnectionThreads(most_connections, low); };
    // Not SO_REUSEPORT, by which two programs would share a port unawares.
    set_socket_options([](int socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    set_tcp_nodelay(true);
    httplib::Headers headers;
    for (const auto& [name, value] : manners) headers.emplace(name, value);
    set_default_headers(std::move(headers));
    set_exception_handler([](const httplib::Request&, httplib::Response& response,
                             const std::exception_ptr&) { response.status = 500; });
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      // Of HEAD the library sends the headers alone.
      if (request.method == "POST") return HandlerResponse::Unhandled;
      get(request, response);
      return HandlerResponse::Handled;
    });
    Post("/.*", [this](const httplib::Request& request, httplib::Response& response) {
      fill(response, site_->post(request.target, request.body));
    });
    if (address.port != 0) {
      if (!bind_to_port(address.host, address.port)) refuse();
    } else {
      const int port = bind_to_any_port(address.host);
      if (port <= 0) refuse();
      address_.port = static_cast<std::uint16_t>(port);
    }
    thread_ = std::thread([this, low] {
      if (low) give_way();
      listen_after_bind();
      ended_ = true;
    });
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  Impl(Impl&&) = delete;
  Impl& operator=(Impl&&) = delete;
  ~Impl() override {
    stopping_ = true;
    // Before it has begun to listen there is nothing that could be stopped.
    while (!is_running() && !ended_) std::this_thread::sleep_for(1ms);
    stop();
    thread_.join();
  }

  [[nodiscard]] const Address& address() const noexcept { return address_; }
  [[nodiscard]] ServerCounts counts() const noexcept {
    return {connections_, requests_, refused_, bytes_sent_};
  }

 private:
  [[noreturn]] void refuse() const {
    throw SetupError({"serve",
                      to_string(address_) + " cannot be listened on: another program has "
                                            "the port, or the address is not this machine's",
                      "give another with --serve ADDR:PORT"});
  }

  static void fill(httplib::Response& response, Reply reply) {
    response.status = reply.status;
    response.body = std::move(reply.body);
    response.set_header("Content-Type", reply.type);
  }

  void get(const httplib::Request& request, httplib::Response& response) {
    const std::string_view target = request.target;
    const std::size_t mark = std::min(target.find('?'), target.size());
    const std::string_view path = target.substr(0, mark);
    if (path == "/api/events") {
      stream(response);
    } else {
      fill(response, site_->get(path, target.substr(std::min(mark + 1, target.size()))));
    }
  }

  void stream(httplib::Response& response) {
    const auto provide = [this, last = std::uint64_t{0}, since = 0](
                             std::size_t, httplib::DataSink& sink) mutable {
      constexpr int quiet = 5;  // seconds, after which it is tried whether the client is there
      const auto event = site_->event(last);
      if (stopping_) return false;
      if (!event && ++since < quiet) return true;
      since = 0;
      return event ? sink.write(event->data(), event->size()) : sink.write(": quiet\n\n", 9);
    };
    response.set_chunked_content_provider("text/event-stream", provide);
  }

  bool process_and_close_socket(socket_t socket) override {
    ++connections_;
    Connection connection(socket, stopping_);
    if (ConnectionThreads::refusing()) {
      // Without waiting: it is the thread that accepts all others.
      const std::string text = refusal(503, "too many connections");
      static_cast<void>(::send(socket, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
      ++refused_;
    } else {
      try {
        while (serve_one(connection)) {
        }
      } catch (const std::exception&) {  // no memory: this client is turned away
        ++refused_;
      }
    }
    bytes_sent_ += connection.bytes_sent();
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    --connections_;
    return true;
  }

  /// @return whether the client may ask again
  bool serve_one(Connection& connection) {
    std::string head;
    CheckedHead checked;
    switch (connection.read_head(head)) {
      case Connection::Got::head:
        checked = check(head, rules_);
        break;
      case Connection::Got::nothing:
        return false;
      case Connection::Got::too_slow:
        checked = {408, "the request took too long", {}, 0};
        break;
      case Connection::Got::too_long:
        checked = {431, "the headers are too long", {}, 0};
        break;
    }
    if (checked.status != 0) {
      ++refused_;
      connection.write_all(refusal(checked.status, checked.why, head.starts_with("HEAD ")));
      return false;
    }
    connection.pass_on(std::move(checked.passed_on), checked.body);
    ++requests_;
    bool closed = false;
    return process_request(connection, false, closed, nullptr) && !closed;
  }

  Address address_;
  Rules rules_;
  Site* site_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> ended_{false};
  std::atomic<std::uint64_t> connections_{0};
  std::atomic<std::uint64_t> requests_{0};
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<std::uint64_t> bytes_sent_{0};
  std::thread thread_;
};

Server::Server(const Address& address, std::string token, Site& site, Priority priority)
    : impl_(std::make_unique<Impl>(address, std::move(token), site, priority)) {}
Server::~Server() = default;

const Address& Server::address() const noexcept { return impl_->address(); }
ServerCounts Server::counts() const noexcept { return impl_->counts(); }

}  // namespace seqloop::http
