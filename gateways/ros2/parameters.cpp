#include "parameters.h"

#include <algorithm>

#include "ros/parameter_services.h"

namespace ros2 {
namespace {

constexpr const char* sim_time = "use_sim_time";

ros::ParameterValue value_of(const std::string& name) {
  ros::ParameterValue value;
  if (name == sim_time) {
    value.type = ros::ParameterValue::is_bool;
    value.bool_value = true;
  }
  return value;
}

ros::SetParametersResult refusal_of(const ros::Parameter& parameter) {
  if (parameter.key != sim_time) return {false, "the node has no parameter \"" + parameter.key + "\"; it has use_sim_time"};
  const bool is_same = parameter.value.type == ros::ParameterValue::is_bool && parameter.value.bool_value;
  return is_same
             ? ros::SetParametersResult{true, ""}
             : ros::SetParametersResult{false, "parameter use_sim_time is true and cannot be changed: the time is that of the simulation"};
}

bool is_asked(const ros::ListParametersRequest& request) {
  return request.prefixes.empty() || std::ranges::find(request.prefixes, sim_time) != request.prefixes.end();
}

}  // namespace

void serve_parameters(Node& node, const NodeName& name) {
  const std::string front = name.full() + "/";
  node.serve<ros::ListParametersRequest, ros::ListParametersResponse>(front + "list_parameters",
                                                                      [](const auto& request, const auto& reply) {
                                                                        ros::ListParametersResponse response;
                                                                        if (is_asked(request)) response.result.names = {sim_time};
                                                                        reply(response);
                                                                      });
  node.serve<ros::GetParametersRequest, ros::GetParametersResponse>(front + "get_parameters", [](const auto& request, const auto& reply) {
    ros::GetParametersResponse response;
    for (const auto& one : request.names) response.values.push_back(value_of(one));
    reply(response);
  });
  node.serve<ros::GetParameterTypesRequest, ros::GetParameterTypesResponse>(front + "get_parameter_types",
                                                                            [](const auto& request, const auto& reply) {
                                                                              ros::GetParameterTypesResponse response;
                                                                              for (const auto& one : request.names)
                                                                                response.types.push_back(value_of(one).type);
                                                                              reply(response);
                                                                            });
  node.serve<ros::DescribeParametersRequest, ros::DescribeParametersResponse>(
      front + "describe_parameters", [](const auto& request, const auto& reply) {
        ros::DescribeParametersResponse response;
        for (const auto& one : request.names) {
          ros::ParameterDescriptor descriptor{.key = one, .type = value_of(one).type};
          if (one == sim_time) {
            descriptor.description = "The node's clock is the simulation's.";
            descriptor.read_only = true;
          }
          response.descriptors.push_back(std::move(descriptor));
        }
        reply(response);
      });
  node.serve<ros::SetParametersRequest, ros::SetParametersResponse>(front + "set_parameters", [](const auto& request, const auto& reply) {
    ros::SetParametersResponse response;
    for (const auto& one : request.parameters) response.results.push_back(refusal_of(one));
    reply(response);
  });
  node.serve<ros::SetParametersAtomicallyRequest, ros::SetParametersAtomicallyResponse>(
      front + "set_parameters_atomically", [](const auto& request, const auto& reply) {
        ros::SetParametersAtomicallyResponse response{{true, ""}};
        for (const auto& one : request.parameters) {
          if (response.result.successful) response.result = refusal_of(one);
        }
        reply(response);
      });
}

}  // namespace ros2
