// A server of one connection, for tests of what speaks to a display.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "support/test.h"

namespace trilens_test {

/// Takes one connection on a port of its own: everything, or so many bytes and then hangs up hard.
class SmallServer {
  public:
    explicit SmallServer(std::size_t most = SIZE_MAX) {
        listener_ = socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        REQUIRE(bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
        REQUIRE(listen(listener_, 1) == 0);
        socklen_t size = sizeof address;
        getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
        address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
        thread_ = std::thread([this, most] { take(most); });
    }
    ~SmallServer() { received(); }

    const std::string& address() const { return address_; }
    /// What has come once the other side has hung up, or has been hung up on.
    const std::vector<std::uint8_t>& received() {
        if (thread_.joinable()) thread_.join();
        return bytes_;
    }

  private:
    void take(std::size_t most) {
        const int connection = accept(listener_, nullptr, nullptr);
        close(listener_);
        std::uint8_t some[4096];
        while (bytes_.size() < most) {
            const ssize_t count = recv(connection, some, std::min(sizeof some, most - bytes_.size()), 0);
            if (count <= 0) break;
            bytes_.insert(bytes_.end(), some, some + count);
        }
        const linger at_once{1, 0};
        if (bytes_.size() >= most) setsockopt(connection, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
        close(connection);
    }

    int listener_ = -1;
    std::string address_;
    std::vector<std::uint8_t> bytes_;
    std::thread thread_;
};

}  // namespace trilens_test
