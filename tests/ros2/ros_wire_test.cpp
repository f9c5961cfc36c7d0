// Messages of ROS 2: type hashes, and bytes that come from the network.
#include <gtest/gtest.h>

#include <random>

#include "ros/action_messages.h"
#include "ros/command_messages.h"
#include "ros/contact_messages.h"
#include "ros/decode.h"
#include "ros/graph_messages.h"
#include "ros/messages.h"
#include "ros/parameter_services.h"
#include "ros/sha256.h"
#include "ros/simulation_services.h"
#include "ros/type_hash.h"

namespace {

using namespace ros;

std::vector<std::uint8_t> bytes_of(const auto& message) {
  const auto octets = encode(message);
  return {octets.begin(), octets.end()};
}

TEST(RosWire, sha256_gives_the_published_digests) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

// The hashes of Iron, Jazzy and later ones, as public files have them: fields and hash cannot part.
TEST(RosWire, type_hashes_are_those_of_ros) {
  struct Row {
    std::string hash;
    std::string_view wanted, name;
  };
  const std::vector<Row> rows = {
      {TypeHash::of<PoseStamped>(), "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8", PoseStamped::name},
      {TypeHash::of<Twist>(), "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a", Twist::name},
      {TypeHash::of<TwistStamped>(), "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64", TwistStamped::name},
      {TypeHash::of<WrenchStamped>(), "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77", WrenchStamped::name},
      {TypeHash::of<Odometry>(), "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0", Odometry::name},
      {TypeHash::of<Log>(), "e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac", Log::name},
      {TypeHash::of<ParameterEvent>(), "043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204", ParameterEvent::name},
      {TypeHash::of<DescribeParametersRequest>(), "05dd1c2bc87dec2627105c8070d6f9725c781a4f2ab852975bf105462b82b644",
       DescribeParametersRequest::name},
      {TypeHash::of<DescribeParametersResponse>(), "ad6747319613c6131589e062e095b469a46cc764f7d0f12a001a49e6cd893995",
       DescribeParametersResponse::name},
      {TypeHash::of<GetParameterTypesRequest>(), "87d7ec5ef545d4daa289d500025d31fb2437bc8b8365ca367161c4dac4be33fd",
       GetParameterTypesRequest::name},
      {TypeHash::of<GetParameterTypesResponse>(), "ac1335dce67c478e669434f6ac2fbff34fcd529580f272d3006785ba8b54e47f",
       GetParameterTypesResponse::name},
      {TypeHash::of<GetParametersRequest>(), "135a9e1c3d7cebef792f6687d7ddf99949b21a0bd9a320d863a9110a3f5cf4d6",
       GetParametersRequest::name},
      {TypeHash::of<GetParametersResponse>(), "9fa773b46e39cc5d02db6224d8fd520bb9caeeffc2b27c96c1e59431baba9f2a",
       GetParametersResponse::name},
      {TypeHash::of<ListParametersRequest>(), "a1b0b5d6b967a5b8ac5bc8563c3ea678f349e312a6a4967227c5a96bc5ce38df",
       ListParametersRequest::name},
      {TypeHash::of<ListParametersResponse>(), "31b937b82de3612426be79f231e386259f97e8dc843e3f2845288b4bfa296bdd",
       ListParametersResponse::name},
      {TypeHash::of<SetParametersAtomicallyRequest>(), "db0bd950ed5ed867a0e90b225e44dea382d762c0762ff3e0ee842190042a59e5",
       SetParametersAtomicallyRequest::name},
      {TypeHash::of<SetParametersAtomicallyResponse>(), "31b1a38c5b0b9d893ee24da45f69638f4561c78461d82d52750f429b534502b8",
       SetParametersAtomicallyResponse::name},
      {TypeHash::of<SetParametersRequest>(), "130d46386b7e84ea9ecf60608a4d83cbe5e5cb7c6cc5b712b7a4e3a6c254e932",
       SetParametersRequest::name},
      {TypeHash::of<SetParametersResponse>(), "7a0e8140a0b8d98308fa81a5403a766e610af29a239caf54b7553227906fc266",
       SetParametersResponse::name},
      {TypeHash::of<ParticipantEntitiesInfo>(), "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e",
       ParticipantEntitiesInfo::name},
      {TypeHash::of<GoalStatusArray>(), "6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e", GoalStatusArray::name},
      {TypeHash::of<GetEntityInfoRequest>(), "9bdd2628d931108734e304ae1fac80d268a46783fa0060d4a43831c54c30f3b3",
       GetEntityInfoRequest::name},
      {TypeHash::of<GetEntityInfoResponse>(), "eaa358f007b09b06645f93b5a1c6ae0389f27bee7747e760122994ab1308e1c8",
       GetEntityInfoResponse::name},
      {TypeHash::of<GetEntityBoundsRequest>(), "41766afd481abfa03a9dface86a487e317da516333af3f5b017df248dd5d7fee",
       GetEntityBoundsRequest::name},
      {TypeHash::of<GetEntityBoundsResponse>(), "728d414a3be6d7689fad9d3218c8378c68fbe08c2cfbf9878ac14de713fcf4c1",
       GetEntityBoundsResponse::name},
      {TypeHash::of<SpawnEntitiesRequest>(), "03f070057ac2ab26d723fe9f07c7d57bd39ace34ad34bb043cdbca36825c98d9",
       SpawnEntitiesRequest::name},
      {TypeHash::of<SpawnEntitiesResponse>(), "85df56d44250220df64762bf3e769cce45f84730eff8b9823093ca3041ecbbf5",
       SpawnEntitiesResponse::name},
      {TypeHash::of<Altimeter>(), "c1e452c867a0dd147e2a612d1f78e5da9675ae5ef75c0950ad1520f004101703", Altimeter::name},
      {TypeHash::of<Contacts>(), "2cf36dd51e105580839fb7d6c028846a6342a8dfd62fde733d05f3e0c9ec4b5b", Contacts::name},
      {TypeHash::of<Clock>(), "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564", Clock::name},
      {TypeHash::of<CameraInfo>(), "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275", CameraInfo::name},
      {TypeHash::of<CompressedImage>(), "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a", CompressedImage::name},
      {TypeHash::of<FluidPressure>(), "22dfb2b145a0bd5a31a1ac3882a1b32148b51d9b2f3bab250290d66f3595bc32", FluidPressure::name},
      {TypeHash::of<Image>(), "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47", Image::name},
      {TypeHash::of<Imu>(), "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b", Imu::name},
      {TypeHash::of<JointState>(), "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e", JointState::name},
      {TypeHash::of<LaserScan>(), "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828", LaserScan::name},
      {TypeHash::of<MagneticField>(), "e80f32f56a20486c9923008fc1a1db07bbb273cbbf6a5b3bfa00835ee00e4dff", MagneticField::name},
      {TypeHash::of<NavSatFix>(), "62223ab3fe210a15976021da7afddc9e200dc9ec75231c1b6a557fc598a65404", NavSatFix::name},
      {TypeHash::of<PointCloud2>(), "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5", PointCloud2::name},
      {TypeHash::of<Range>(), "b42b62562e93cbfe9d42b82fe5994dfa3d63d7d5c90a317981703f7388adff3a", Range::name},
      {TypeHash::of<DeleteEntityRequest>(), "4b41b2ebdc313a0c98c7c2218849edc8b7b905fd759a23b68c576496a47dc792", DeleteEntityRequest::name},
      {TypeHash::of<DeleteEntityResponse>(), "2f68929b527a3bbee03637a1c8192f2aa2982807738389aa0781f8e785673ca7",
       DeleteEntityResponse::name},
      {TypeHash::of<GetCurrentWorldRequest>(), "414ac6e1c5fd5f8be0b828ca7ff8cbee7166297809de31a36129f1d0913cd877",
       GetCurrentWorldRequest::name},
      {TypeHash::of<GetCurrentWorldResponse>(), "039f99eb4e156ac597efed7598249921f8e47e5bff8c299d86ab081983a3a52a",
       GetCurrentWorldResponse::name},
      {TypeHash::of<GetEntitiesStatesRequest>(), "0af5302d3526834e83bd9861fbcc5214af2b9a4b0c93a965840fb1a6c2891724",
       GetEntitiesStatesRequest::name},
      {TypeHash::of<GetEntitiesStatesResponse>(), "b651848f4d93a2b0ec5ec3f36659297ca30547c499f933eb279b60f8be434315",
       GetEntitiesStatesResponse::name},
      {TypeHash::of<GetEntitiesRequest>(), "f0a4c6c0c39c87f84cbd1ea31956b9f39b3fa538ae9c4aa7fc243a32360e8c70", GetEntitiesRequest::name},
      {TypeHash::of<GetEntitiesResponse>(), "dd1916edbdc659d355e77980b16ed6eb4d41d5ff445557931ed65c58b00f7b2c", GetEntitiesResponse::name},
      {TypeHash::of<GetEntityStateRequest>(), "580141cc957c4ee99a7e46bc545db351ab9ce6c3099d4092b1186ddc6a38bd5a",
       GetEntityStateRequest::name},
      {TypeHash::of<GetEntityStateResponse>(), "125f1ca9dc2fc072443deb28587bbb1026fa34db4dfaf59e9a6b7128e0c81331",
       GetEntityStateResponse::name},
      {TypeHash::of<GetSimulationStateRequest>(), "c6d65bc5c0a95ca2886bc57f146f803e01722c84ddb5acd5f32a4417f55eecfb",
       GetSimulationStateRequest::name},
      {TypeHash::of<GetSimulationStateResponse>(), "dc80ce852a5ab04c2b23cdd47910cee1bcc46e0f1931cac85825e6916b15517f",
       GetSimulationStateResponse::name},
      {TypeHash::of<GetSimulatorFeaturesRequest>(), "982b8c1adef1d556f6ecdc019d1269fc39413626a9222d73b4fc874bd798b7db",
       GetSimulatorFeaturesRequest::name},
      {TypeHash::of<GetSimulatorFeaturesResponse>(), "ede4dc8227cbb2f86a24612c999dcaa67d17dab21dab566cefdc233e7a2a65d1",
       GetSimulatorFeaturesResponse::name},
      {TypeHash::of<GetSpawnablesRequest>(), "3e1d1577446a80da956db3e82363c2d66364f9802f6e9572d89497933207d921",
       GetSpawnablesRequest::name},
      {TypeHash::of<GetSpawnablesResponse>(), "4e532ac531e2d0bb495a8b53409a8025551f55329250537a3d5a28c5d7ce36af",
       GetSpawnablesResponse::name},
      {TypeHash::of<ResetSimulationRequest>(), "2c766d09c3aa30f01fadc55a42fd760b63db358c7d1d3b6a64ea9978225ffbc7",
       ResetSimulationRequest::name},
      {TypeHash::of<ResetSimulationResponse>(), "718428121e0f1755720878d3c28f1688da7581ee5a5d56d26d10d941a28a50a0",
       ResetSimulationResponse::name},
      {TypeHash::of<SetEntityStateRequest>(), "95cdfbffcd9c4d0133b2079bdcadd4420ce86dd255c11a3dfed7f9f907fd304d",
       SetEntityStateRequest::name},
      {TypeHash::of<SetEntityStateRequest2>(), "0ec3cca7e2bde7323c0c7ea4a5a7947f81edb90c144fc0aef5e2052e94e10061",
       SetEntityStateRequest2::name},
      {TypeHash::of<SetEntityStateResponse>(), "bbd9bcb2def000f1ed8cb9482abff46c5a11cfe4184203f336b920f249d757f4",
       SetEntityStateResponse::name},
      {TypeHash::of<SetSimulationStateRequest>(), "73283477d36ba619db2ac37a3e599077ca244502c9d8ca2a7183afcb2224f476",
       SetSimulationStateRequest::name},
      {TypeHash::of<SetSimulationStateResponse>(), "6351aebf2bbf06e2993977918b944240f7403b532a9e4a344c53e71a56afd174",
       SetSimulationStateResponse::name},
      {TypeHash::of<SpawnEntityRequest>(), "fdcf97087f59eed1ad0b75696ea97ffbb44d104f62f177fcd5a31ab67c6fc923", SpawnEntityRequest::name},
      {TypeHash::of<SpawnEntityRequest2>(), "9bc04fe30d4844466c57b7b090fd7e9aa426995f3eb6ff9a726826ab7223e1fd", SpawnEntityRequest2::name},
      {TypeHash::of<SpawnEntityResponse>(), "be8c9fc03b6faaf95570949c80195c8ca75dd99f7efc23262309d497b2923982", SpawnEntityResponse::name},
      {TypeHash::of<StepSimulationRequest>(), "cda33f6887815f3dce0f90e61fd8efd39bda13ae264ddede15c33fbad890630e",
       StepSimulationRequest::name},
      {TypeHash::of<StepSimulationResponse>(), "5b4acf2d0ce7c3fc125d0bef2acb9b5a81377e80db6b696b81beeffb9824fb5c",
       StepSimulationResponse::name},
      {TypeHash::of<Int8>(), "26525065a403d972cb672f0777e333f0c799ad444ae5fcd79e43d1e73bd0f440", Int8::name},
      {TypeHash::of<Int16>(), "1dcc3464e47c288a55f943a389d337cdb06804de3f5cd7a266b0de718eee17e5", Int16::name},
      {TypeHash::of<Int32>(), "b6578ded3c58c626cfe8d1a6fb6e04f706f97e9f03d2727c9ff4e74b1cef0deb", Int32::name},
      {TypeHash::of<Int64>(), "8cd1048c2f186b6bd9a92472dc1ce51723c0833a221e2b7aecfff111774f4b49", Int64::name},
      {TypeHash::of<UInt8>(), "6138bd83d8c3569cb80a667db03cfc1629f529fee79d944c39c34e352e72f010", UInt8::name},
      {TypeHash::of<UInt16>(), "08a406e4b022bc22e907f985d6a9e9dd1d4fbecae573549cf49350113e7757b1", UInt16::name},
      {TypeHash::of<UInt32>(), "a5c874829b752bc5fa190024b0ad76f578cc278271e855c7d02a818b3516fb4a", UInt32::name},
      {TypeHash::of<UInt64>(), "fbdc52018fc13755dce18024d1a671c856aa8b4aaf63adfb095b608f98e8c943", UInt64::name},
      {TypeHash::of<Float32>(), "7170d3d8f841f7be3172ce5f4f59f3a4d7f63b0447e8b33327601ad64d83d6e2", Float32::name},
      {TypeHash::of<Bool>(), "feb91e995ff9ebd09c0cb3d2aed18b11077585839fb5db80193b62d74528f6c9", Bool::name},
      {TypeHash::of<Int8MultiArray>(), "f21998d4b492abd63330765d75d5831238d400740386f651f13a872a4d2188db", Int8MultiArray::name},
      {TypeHash::of<Int16MultiArray>(), "b58810e8e5b90fb19a5062469eb8409f5ab11a446d60de7157a1457e52a076ce", Int16MultiArray::name},
      {TypeHash::of<Int32MultiArray>(), "84a7346323525d1b4dfca899df3820f245e54009dac5a6b69217d14fdefd1701", Int32MultiArray::name},
      {TypeHash::of<Int64MultiArray>(), "e60f9fe34d697f0939ad49d33158693c1277fbac0e2f04b7c2995dc21c89b422", Int64MultiArray::name},
      {TypeHash::of<UInt8MultiArray>(), "5687e861b8d307a5e48b7515467ae7a5fc2daf805bd0ce6d8e9e604bade9f385", UInt8MultiArray::name},
      {TypeHash::of<UInt16MultiArray>(), "94fe73428ec63baecc774f8fb82406123e9291cf728f1b7c91caf5335129492b", UInt16MultiArray::name},
      {TypeHash::of<UInt32MultiArray>(), "6c2577c7ad3cbdcc2164a41c12f1d5ad314ea320f3fb1ee47e78019fe16bb5b0", UInt32MultiArray::name},
      {TypeHash::of<UInt64MultiArray>(), "fc1c685c2f76bdc6983da025cb25d2db5fb5157b059e300f6d957d86f981b366", UInt64MultiArray::name},
      {TypeHash::of<Float32MultiArray>(), "0599f6f85b4bfca379873a0b4375a0aca022156bd2d7021275d116ed1fa8bfe0", Float32MultiArray::name},
      {TypeHash::of<BatteryState>(), "4bee5dfce981c98faa6828b868307a0a73f992ed0789f374ee96c8f840e69741", BatteryState::name},
      {TypeHash::of<PointStamped>(), "4c0296af86e01e562e9e0405d138a01537247580076c58ea38d7923ac1045897", PointStamped::name},
      {TypeHash::of<Vector3Stamped>(), "d4829622288cbb443886e7ea94ea5671a3b1be6bab4ad04224432a65f7d7887a", Vector3Stamped::name},
      {TypeHash::of<QuaternionStamped>(), "381add86c6c3160644d228ca342182c7fd6c7fab11c7a85ad817a9cc22dbac6e", QuaternionStamped::name},
      {TypeHash::of<PoseWithCovarianceStamped>(), "26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e",
       PoseWithCovarianceStamped::name},
      {TypeHash::of<TwistWithCovarianceStamped>(), "77b67434531e6529b7a0091357b186b6ebdb17fd9ffd3e0c7ce9d3fb11a44563",
       TwistWithCovarianceStamped::name},
      {TypeHash::of<MarkerArray>(), "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf", MarkerArray::name},
      {TypeHash::of<Detection2DArray>(), "214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968", Detection2DArray::name},
      {TypeHash::of<Detection3DArray>(), "793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018", Detection3DArray::name},
      {TypeHash::of<GetSpawnablesResponse2>(), "cb61fd741c429d6bc689514b7bfc65bb1518126961317acc6e414a841dc43daa",
       GetSpawnablesResponse2::name},
      {TypeHash::of<Float64>(), "705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a", Float64::name},
      {TypeHash::of<Float64MultiArray>(), "1025ddc6b9552d191f89ef1a8d2f60f3d373e28b283d8891ddcc974e8c55397f", Float64MultiArray::name},
      {TypeHash::of<Text>(), "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18", Text::name},
      {TypeHash::of<TFMessage>(), "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087", TFMessage::name},
      {TypeHash::of<JointTrajectory>(), "179b33eba59d676f6d967ac71fe35e7ca2f64b2f3928f4a018cec115e213796e", JointTrajectory::name},
  };
  for (const Row& row : rows) EXPECT_EQ(row.hash, "RIHS01_" + std::string(row.wanted)) << row.name;
  EXPECT_GE(rows.size(), 90U);
}

TEST(RosWire, the_graph_of_a_participant_has_the_bytes_of_rmw) {
  ParticipantEntitiesInfo info;
  info.gid.data.fill(0xaa);
  Gid writer;
  writer.data.fill(0xbb);
  info.node_entities_info_seq.push_back({BoundedText<256>(std::string("/r1")), BoundedText<256>(std::string("sim")), {}, {writer}});
  std::vector<std::uint8_t> wanted = {0, 1, 0, 0};
  wanted.insert(wanted.end(), 16, 0xaa);
  const std::uint8_t middle[] = {1, 0, 0, 0, 4, 0, 0, 0, '/', 'r', '1', 0, 4, 0, 0, 0, 's', 'i', 'm', 0, 0, 0, 0, 0, 1, 0, 0, 0};
  wanted.insert(wanted.end(), std::begin(middle), std::end(middle));
  wanted.insert(wanted.end(), 16, 0xbb);
  EXPECT_EQ(bytes_of(info), wanted);
}

TEST(RosWire, a_message_is_read_back_from_both_byte_orders) {
  const TwistStamped sent{{{1, 2}, "base"}, {{1.5, 0, 0}, {0, 0, -2.5}}};
  const auto little = decode<TwistStamped>(bytes_of(sent));
  ASSERT_TRUE(little);
  EXPECT_EQ(little->header.frame_id, "base");
  EXPECT_EQ(little->twist.angular.z, -2.5);
  const std::vector<std::uint8_t> big = {0, 0, 0, 0, 0x3f, 0xf8, 0, 0, 0, 0, 0, 0};  // 1.5
  const auto number = decode<Float64>(big);
  ASSERT_TRUE(number);
  EXPECT_EQ(number->data, 1.5);
}

TEST(RosWire, sequences_and_texts_are_read_back) {
  JointTrajectory sent;
  sent.joint_names = {"a", "bc"};
  sent.points.push_back({{1, 2}, {}, {3}, {}, {4, 5}});
  const auto read = decode<JointTrajectory>(bytes_of(sent));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->joint_names, sent.joint_names);
  ASSERT_EQ(read->points.size(), 1U);
  EXPECT_EQ(read->points[0].accelerations, std::vector<double>{3});
  EXPECT_EQ(read->points[0].time_from_start.nanosec, 5U);
}

TEST(RosWire, a_message_that_ends_early_is_refused) {
  JointTrajectory sent;
  sent.joint_names = {"shoulder", "elbow"};
  sent.points.push_back({{1, 2}, {3, 4}, {}, {}, {1, 0}});
  const auto whole = bytes_of(sent);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(decode<JointTrajectory>(std::span(whole).first(size))) << size << " of " << whole.size() << " bytes";
}

TEST(RosWire, a_count_beyond_the_end_allocates_nothing) {
  const std::vector<std::uint8_t> bytes = {0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff};
  EXPECT_FALSE(decode<GetParametersRequest>(bytes));
  EXPECT_FALSE(decode<Text>(bytes));
}

TEST(RosWire, any_damage_is_read_or_refused) {
  std::mt19937 random(7);
  SetParametersRequest sent;
  sent.parameters.push_back({"use_sim_time", {}});
  sent.parameters.back().value.string_array_value = {"x", "yz"};
  sent.parameters.back().value.bool_array_value = {true, false};
  const auto whole = bytes_of(sent);
  int read = 0;
  for (int i = 0; i < 20000; ++i) {
    auto damaged = whole;
    for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    if (random() % 4 == 0) damaged.resize(random() % damaged.size());
    if (decode<SetParametersRequest>(damaged)) ++read;
  }
  EXPECT_GT(read, 0);
}

}  // namespace
