#include "setup/keys/policy.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace diminish {
namespace {

/// Cyclone DDS refuses what ends later.
constexpr const char* every_domain =
    "<domains><id_range><min>0</min><max>230</max></id_range></domains>";

std::string document(const char* schema, const std::string& content) {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
      "xsi:noNamespaceSchemaLocation=\"http://www.omg.org/spec/DDS-SECURITY/20170901/{}\">\n"
      "{}</dds>\n",
      schema, content);
}

/// The standard's format; UTC, as it says where there is no zone.
std::string date(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

std::string rule(const char* what, const std::vector<std::string>& topics) {
  if (topics.empty()) return "";
  std::string text = fmt::format("        <{}><topics>\n", what);
  for (const std::string& topic : topics) {
    // On the wire ROS's topics have "rt" in front (dds::wire_name).
    text += fmt::format("          <topic>{}{}</topic>\n", topic == "*" ? "" : "rt", topic);
  }
  return text + fmt::format("        </topics></{}>\n", what);
}

}  // namespace

std::string governance_xml() {
  return document(
      "omg_shared_ca_governance.xsd",
      fmt::format("  <domain_access_rules>\n"
                  "    <domain_rule>\n"
                  "      {}\n"
                  "      <allow_unauthenticated_participants>false"
                  "</allow_unauthenticated_participants>\n"
                  "      <enable_join_access_control>true</enable_join_access_control>\n"
                  "      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>\n"
                  "      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>\n"
                  "      <rtps_protection_kind>SIGN</rtps_protection_kind>\n"
                  "      <topic_access_rules>\n"
                  "        <topic_rule>\n"
                  "          <topic_expression>*</topic_expression>\n"
                  "          <enable_discovery_protection>true</enable_discovery_protection>\n"
                  "          <enable_liveliness_protection>true</enable_liveliness_protection>\n"
                  "          <enable_read_access_control>true</enable_read_access_control>\n"
                  "          <enable_write_access_control>true</enable_write_access_control>\n"
                  "          <metadata_protection_kind>ENCRYPT</metadata_protection_kind>\n"
                  "          <data_protection_kind>NONE</data_protection_kind>\n"
                  "        </topic_rule>\n"
                  "      </topic_access_rules>\n"
                  "    </domain_rule>\n"
                  "  </domain_access_rules>\n",
                  every_domain));
}

std::string permissions_xml(const Permissions& permissions) {
  return document(
      "omg_shared_ca_permissions.xsd",
      fmt::format(
          "  <permissions>\n"
          "    <grant name=\"{0}\">\n"
          "      <subject_name>CN={0}</subject_name>\n"
          "      <validity><not_before>{1}</not_before><not_after>{2}</not_after></validity>\n"
          "      <allow_rule>\n"
          "        {3}\n"
          "{4}{5}"
          "      </allow_rule>\n"
          "      <default>DENY</default>\n"
          "    </grant>\n"
          "  </permissions>\n",
          permissions.subject, date(permissions.from), date(permissions.until), every_domain,
          rule("publish", permissions.publish), rule("subscribe", permissions.subscribe)));
}

}  // namespace diminish
