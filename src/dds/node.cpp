#include "dds/node.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <ifaddrs.h>
#include <netinet/in.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/rtps/flowcontrol/FlowControllerDescriptor.hpp>
#include <filesystem>
#include <map>
#include <sstream>
#include <tuple>
#include <vector>

#include "core/text.h"
#include "dds/key_files.h"
#include "dds/payload_type.h"
#include "diminish/error.h"

namespace diminish::dds {
namespace {

using eprosima::fastdds::dds::DataSharingQosPolicy;
using eprosima::fastdds::dds::DomainParticipantFactory;
using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastdds::dds::ResourceLimitsQosPolicy;
using eprosima::fastdds::dds::TypeSupport;
using eprosima::fastdds::rtps::FlowControllerDescriptor;
using eprosima::fastdds::rtps::SharedMemTransportDescriptor;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using rtps::IPLocator;
using rtps::Locator_t;

constexpr const char* loopback = "127.0.0.1";
constexpr int most_domain = 232;
/// How many of a machine's processes are looked for on its loopback, where nothing is broadcast.
constexpr std::uint32_t most_processes = 32;
/// Room for a few pictures of several megabytes.
constexpr std::uint32_t segment_bytes = 32u << 20;
/// Shared memory that must be free for messages to be shared. Who writes where there is none is
/// killed.
constexpr std::uint64_t shared_bytes = 512u << 20;
constexpr std::uint32_t socket_bytes = 8u << 20;
/// Of 1500 that Ethernet carries: without the heads of IP and UDP.
constexpr std::uint32_t packet_bytes = 1472;
/// How what is sent is spread over time, where there is a limit.
constexpr const char* flow_controller_name = "limited";
constexpr std::uint64_t flow_period_ms = 5;

/// A program says each second that it is there, and is forgotten after five without a word: one
/// that comes back is met within about a second.
constexpr std::int32_t announcement_s = 1;
constexpr std::int32_t patience_s = 5;
/// Where programs say so (OMG, DDSI-RTPS 2.5, 9.6.2.3).
constexpr const char* discovery_group = "239.255.0.1";

/// With the port that the standard gives it.
Locator_t udp_locator(const std::string& address) {
  Locator_t locator;
  IPLocator::setIPv4(locator, address);
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = 0;
  return locator;
}

DomainParticipantQos participant_qos(const Network& network) {
  DomainParticipantQos qos;
  qos.name("diminish");
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration_announcementperiod = {announcement_s, 0};
  discovery.leaseDuration = {patience_s, 0};
  qos.transport().use_builtin_transports = false;
  const auto udp = std::make_shared<UDPv4TransportDescriptor>();
  const std::string& address = network.interface.empty() ? loopback : network.interface;
  udp->interfaceWhiteList = {address};
  udp->sendBufferSize = socket_bytes;
  udp->receiveBufferSize = socket_bytes;
  if (network.in_packets) udp->maxMessageSize = packet_bytes;
  if (network.interface.empty()) {
    udp->maxInitialPeersRange = most_processes;
    Locator_t peer;
    IPLocator::setIPv4(peer, loopback);
    qos.wire_protocol().builtin.initialPeersList.push_back(peer);
  }
  qos.transport().user_transports.push_back(udp);
  if (network.shared_memory) {
    // Who is killed leaves a mailbox in shared memory that takes seconds to be found dead, and what
    // is said of newcomers waits behind it. So discovery goes by UDP alone, like a network's.
    auto& builtin = qos.wire_protocol().builtin;
    builtin.metatrafficUnicastLocatorList.push_back(udp_locator(address));
    if (!network.interface.empty()) {
      builtin.metatrafficMulticastLocatorList.push_back(udp_locator(discovery_group));
    }
    const auto memory = std::make_shared<SharedMemTransportDescriptor>();
    memory->segment_size(segment_bytes);
    qos.transport().user_transports.push_back(memory);
  }
  if (network.most_mbits > 0) {
    const auto flow = std::make_shared<FlowControllerDescriptor>();
    flow->name = flow_controller_name;
    flow->period_ms = flow_period_ms;
    flow->max_bytes_per_period =
        static_cast<std::int32_t>(network.most_mbits * 1e6 / 8 * flow_period_ms / 1000);
    qos.flow_controllers().push_back(flow);
  }
  return qos;
}

/// DDS Security 1.1, 9: its builtin plugins, which every implementation has. Throws Error.
void use_keys(const std::filesystem::path& folder, DomainParticipantQos& qos) {
  const KeyFiles files(folder);
  check(files);
  const auto set = [&](const char* name, const std::string& value) {
    qos.properties().properties().emplace_back(std::string("dds.sec.") + name, value);
  };
  const auto file = [](const std::filesystem::path& path) {
    return "file://" + std::filesystem::absolute(path).string();
  };
  set("auth.plugin", "builtin.PKI-DH");
  set("auth.builtin.PKI-DH.identity_ca", file(files.identity_authority));
  set("auth.builtin.PKI-DH.identity_certificate", file(files.certificate));
  set("auth.builtin.PKI-DH.private_key", file(files.private_key));
  set("access.plugin", "builtin.Access-Permissions");
  set("access.builtin.Access-Permissions.permissions_ca", file(files.permissions_authority));
  set("access.builtin.Access-Permissions.governance", file(files.governance));
  set("access.builtin.Access-Permissions.permissions", file(files.permissions));
  set("crypto.plugin", "builtin.AES-GCM-GMAC");
}

/// Of this user's programs that have the same shared memory, which containers may not have. Others
/// could not write into what this user made. Nothing where there is little of it.
std::optional<std::uint16_t> find_shared_domain() {
  struct statvfs space {};
  struct stat mount {};
  if (statvfs(shared_memory_folder, &space) != 0 ||
      space.f_bavail * space.f_frsize < shared_bytes || stat(shared_memory_folder, &mount) != 0) {
    return std::nullopt;
  }
  // A collision of two users in 65536 costs what they send to each other.
  constexpr std::uint64_t spread = 0x9e3779b97f4a7c15;
  const std::uint64_t both = (std::uint64_t{getuid()} + 1) * spread ^ mount.st_dev;
  return static_cast<std::uint16_t>(both * spread >> 48);
}

/// Throws Error if no network interface of this machine has the address. Fast DDS would say
/// nothing.
void expect_own(const std::string& address) {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return;
  std::vector<std::string> own;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* const internet = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
    inet_ntop(AF_INET, &internet->sin_addr, text.data(), text.size());
    own.emplace_back(text.data());
  }
  freeifaddrs(all);
  if (std::find(own.begin(), own.end(), address) != own.end()) return;
  throw Error(Error::device, fmt::format("interface: expected an address of this machine, one of "
                                         "{}, got '{}'",
                                         join(own), printable(address)));
}

}  // namespace

int default_domain() {
  const char* const text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == 0) return 0;
  const auto number = parse_number(text);
  if (!number || *number < 0 || *number > most_domain || *number != static_cast<int>(*number)) {
    throw Error(fmt::format("ROS_DOMAIN_ID: expected a whole number from 0 to {}, got '{}'",
                            most_domain, printable(text)));
  }
  return static_cast<int>(*number);
}

std::string wire_name(const std::string& ros_name) {
  return (ros_name.starts_with('/') ? "rt" : "rt/") + ros_name;
}

void expect_made(const void* made, const std::string& what) {
  if (made == nullptr) throw Error(Error::device, "ROS 2: " + what);
}

Node::Implementation::Implementation(const Network& network) {
  if (!network.interface.empty()) expect_own(network.interface);
  if (network.most_mbits > 0) flow_controller = flow_controller_name;
  if (!network.keys.empty()) refusal = ": do the permissions in " + network.keys + " allow it?";
  if (network.is_within_machine() && network.most_mbits == 0) shared_domain = find_shared_domain();
  if (network.shared_memory) remove_leftovers();
  // It would write to the program's standard output.
  eprosima::fastdds::dds::Log::ClearConsumers();
  DomainParticipantQos qos = participant_qos(network);
  std::string doubt;
  if (!network.keys.empty()) {
    use_keys(network.keys, qos);
    doubt = ", or do the permissions in " + network.keys + " not allow it";
  }
  participant = DomainParticipantFactory::get_instance()->create_participant(
      static_cast<std::uint32_t>(network.domain), qos, &discovery,
      eprosima::fastdds::dds::StatusMask::none());
  expect_made(participant, fmt::format("no participant in domain {}: are all of its ports taken{}?",
                                       network.domain, doubt));
  if (shared_domain) {
    std::ostringstream prefix;
    prefix << participant->guid().guidPrefix;
    mark.emplace(prefix.str());
  }
}

Node::Implementation::~Implementation() {
  if (participant == nullptr) return;
  participant->delete_contained_entities();
  DomainParticipantFactory::get_instance()->delete_participant(participant);
}

DataSharingQosPolicy Node::Implementation::data_sharing(Delivery delivery) const {
  DataSharingQosPolicy policy;
  if (shared_domain && delivery == Delivery::newest) {
    policy.automatic(std::vector<std::uint16_t>{*shared_domain});
  } else {
    policy.off();
  }
  return policy;
}

void keep_at_most(int messages, ResourceLimitsQosPolicy& limits) {
  limits.max_samples = messages;
  limits.max_instances = 1;
  limits.max_samples_per_instance = messages;
  limits.allocated_samples = 0;
}

eprosima::fastdds::dds::Topic* Node::Implementation::topic(const Topic& topic) {
  const std::lock_guard lock(mutex);
  const std::string name = wire_name(topic.name);
  if (auto* const known = participant->lookup_topicdescription(name)) {
    if (known->get_type_name() != topic.type) {
      throw Error(fmt::format("ROS 2: expected {} to be of {}, it is used as {}", topic.name,
                              topic.type, known->get_type_name()));
    }
    return static_cast<eprosima::fastdds::dds::Topic*>(known);
  }
  if (!participant->find_type(topic.type)) {
    TypeSupport(new PayloadType(topic.type, most_message_bytes)).register_type(participant);
  }
  auto* const made =
      participant->create_topic(name, topic.type, eprosima::fastdds::dds::TOPIC_QOS_DEFAULT);
  expect_made(made, topic.name + " is no topic");
  return made;
}

std::shared_ptr<Node> Node::open(const Network& network) {
  static std::mutex mutex;
  static std::map<std::tuple<int, std::string, bool, double, std::string, bool>,
                  std::weak_ptr<Node>>
      nodes;
  const std::lock_guard lock(mutex);
  std::weak_ptr<Node>& known = nodes[{network.domain, network.interface, network.shared_memory,
                                      network.most_mbits, network.keys, network.in_packets}];
  if (auto node = known.lock()) return node;
  std::shared_ptr<Node> node(new Node(network));
  known = node;
  return node;
}

Node::Node(const Network& network) : implementation_(std::make_unique<Implementation>(network)) {}

Node::~Node() = default;

}  // namespace diminish::dds
