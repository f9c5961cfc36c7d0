#include "parameters.h"

#include <algorithm>

#include "ros/messages.h"
#include "ros/parameter_services.h"

namespace ros2 {
namespace {

constexpr const char* sim_time = "use_sim_time";

ros::ParameterValue value_of(const std::string& name, bool is_sim_time) {
  ros::ParameterValue value;
  if (name == sim_time) {
    value.type = ros::ParameterValue::is_bool;
    value.bool_value = is_sim_time;
  }
  return value;
}

ros::SetParametersResult answer_to(const ros::Parameter& parameter, bool is_sim_time) {
  if (parameter.key != sim_time) return {false, "the node has no parameter \"" + parameter.key + "\"; it has use_sim_time"};
  if (parameter.value.type == ros::ParameterValue::is_bool && parameter.value.bool_value == is_sim_time) return {true, ""};
  return {false, is_sim_time ? "parameter use_sim_time is true and cannot be changed: the time is that of the simulation"
                             : "parameter use_sim_time is false and cannot be changed: times are those of the components"};
}

bool is_asked(const ros::ListParametersRequest& request) {
  return request.prefixes.empty() || std::ranges::find(request.prefixes, sim_time) != request.prefixes.end();
}

void serve_parameters(Node& node, bool is_sim_time) {
  const std::string front = node.name().full() + "/";
  node.serve<ros::ListParametersRequest, ros::ListParametersResponse>(front + "list_parameters",
                                                                      [](const auto& request, const auto& reply) {
                                                                        ros::ListParametersResponse response;
                                                                        if (is_asked(request)) response.result.names = {sim_time};
                                                                        reply(response);
                                                                      });
  node.serve<ros::GetParametersRequest, ros::GetParametersResponse>(front + "get_parameters",
                                                                    [is_sim_time](const auto& request, const auto& reply) {
                                                                      ros::GetParametersResponse response;
                                                                      for (const auto& one : request.names)
                                                                        response.values.push_back(value_of(one, is_sim_time));
                                                                      reply(response);
                                                                    });
  node.serve<ros::GetParameterTypesRequest, ros::GetParameterTypesResponse>(front + "get_parameter_types",
                                                                            [is_sim_time](const auto& request, const auto& reply) {
                                                                              ros::GetParameterTypesResponse response;
                                                                              for (const auto& one : request.names)
                                                                                response.types.push_back(value_of(one, is_sim_time).type);
                                                                              reply(response);
                                                                            });
  node.serve<ros::DescribeParametersRequest, ros::DescribeParametersResponse>(
      front + "describe_parameters", [is_sim_time](const auto& request, const auto& reply) {
        ros::DescribeParametersResponse response;
        for (const auto& one : request.names) {
          ros::ParameterDescriptor descriptor{.key = one, .type = value_of(one, is_sim_time).type};
          if (one == sim_time) {
            descriptor.description = "Whether the time of the node is that of /clock.";
            descriptor.read_only = true;
          }
          response.descriptors.push_back(std::move(descriptor));
        }
        reply(response);
      });
  node.serve<ros::SetParametersRequest, ros::SetParametersResponse>(front + "set_parameters",
                                                                    [is_sim_time](const auto& request, const auto& reply) {
                                                                      ros::SetParametersResponse response;
                                                                      for (const auto& one : request.parameters)
                                                                        response.results.push_back(answer_to(one, is_sim_time));
                                                                      reply(response);
                                                                    });
  node.serve<ros::SetParametersAtomicallyRequest, ros::SetParametersAtomicallyResponse>(
      front + "set_parameters_atomically", [is_sim_time](const auto& request, const auto& reply) {
        ros::SetParametersAtomicallyResponse response{{true, ""}};
        for (const auto& one : request.parameters) {
          if (response.result.successful) response.result = answer_to(one, is_sim_time);
        }
        reply(response);
      });
}

}  // namespace

Writer* complete_node(Node& node, const NodeParameters& parameters) {
  Writer* log = node.advertise<ros::Log>("/rosout", {true, 100});
  node.advertise<ros::ParameterEvent>("/parameter_events", {false, 1000});
  if (parameters.are_served) serve_parameters(node, parameters.is_sim_time);
  return log;
}

}  // namespace ros2
