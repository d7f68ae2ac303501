#include "server/tls.h"

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "tests/io/testing.h"
#include "tests/server/certificates.h"

namespace lightfit {
namespace {

using testing::CertificateAuthority;
using testing::CertifiedKey;
using testing::HasAll;

// Waits end as soon as what they wait for happens; this is when they give up.
constexpr absl::Duration kPatience = absl::Seconds(60);
constexpr absl::Duration kReloadInterval = absl::Milliseconds(20);

// Collects what the credentials log.
class Log {
 public:
  TlsLog Writer() {
    return {[this](const std::string& text) { Add("info: " + text); },
            [this](const std::string& text) { Add("warning: " + text); }};
  }

  int Count(const std::string& part) {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(std::count_if(lines_.begin(), lines_.end(), [&](const auto& line) {
      return absl::StrContains(line, part);
    }));
  }

  // Until a line has `part`.
  ::testing::AssertionResult Has(const std::string& part) {
    const absl::Time deadline = absl::Now() + kPatience;
    while (Count(part) == 0) {
      if (absl::Now() > deadline) return ::testing::AssertionFailure() << "no line: " << part;
      absl::SleepFor(absl::Milliseconds(5));
    }
    return ::testing::AssertionSuccess();
  }

 private:
  void Add(std::string line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(std::move(line));
  }

  std::mutex mutex_;
  std::vector<std::string> lines_;
};

// Written in place, as `cp` does: the file is empty for a moment.
void Write(const std::string& path, absl::string_view text) {
  std::ofstream(path, std::ios::binary) << text;
}

// A server that answers health checks alone.
class HealthServer {
 public:
  explicit HealthServer(const TlsOptions& options) {
    grpc::EnableDefaultHealthCheckService(true);
    auto credentials = ReloadingCredentials::Start(options, log_.Writer());
    if (!credentials.ok()) ADD_FAILURE() << credentials.status();
    if (!credentials.ok()) return;
    credentials_ = *std::move(credentials);
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", credentials_->credentials(), &port_);
    builder.RegisterCallbackGenericService(&others_);
    server_ = builder.BuildAndStart();
    EXPECT_NE(server_, nullptr);
  }

  ~HealthServer() {
    if (server_ != nullptr) server_->Shutdown();
  }

  Log& log() { return log_; }

  // One call over a connection of its own.
  struct Answer {
    grpc::Status status;
    std::string server_name;  // in the certificate that the server showed
  };
  Answer Check(const std::string& root, const CertifiedKey& client = {}) const {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    const auto credentials = grpc::SslCredentials({root, client.key, client.certificate});
    const auto channel =
        grpc::CreateCustomChannel(absl::StrCat("127.0.0.1:", port_), credentials, arguments);
    grpc::ClientContext context;
    context.set_deadline(absl::ToChronoTime(absl::Now() + kPatience));
    const grpc::Slice empty;
    const grpc::ByteBuffer request(&empty, 1);
    grpc::ByteBuffer response;
    std::promise<grpc::Status> done;
    grpc::GenericStub(channel).UnaryCall(
        &context,
        "/grpc.health.v1.Health/Check",
        {},
        &request,
        &response,
        [&done](const grpc::Status& status) { done.set_value(status); });
    Answer answer;
    answer.status = done.get_future().get();
    if (!answer.status.ok()) return answer;
    for (const grpc::string_ref& name :
         context.auth_context()->FindPropertyValues(GRPC_X509_CN_PROPERTY_NAME)) {
      answer.server_name.assign(name.data(), name.size());
    }
    return answer;
  }

  // Calls until the server shows the certificate `name`; no call may fail meanwhile.
  ::testing::AssertionResult TurnsTo(const std::string& name, const std::string& root) const {
    const absl::Time deadline = absl::Now() + kPatience;
    while (absl::Now() < deadline) {
      const Answer answer = Check(root);
      if (!answer.status.ok()) {
        return ::testing::AssertionFailure() << answer.status.error_message();
      }
      if (answer.server_name == name) return ::testing::AssertionSuccess();
      absl::SleepFor(absl::Milliseconds(10));
    }
    return ::testing::AssertionFailure() << "never shows " << name;
  }

 private:
  Log log_;
  std::unique_ptr<ReloadingCredentials> credentials_;
  grpc::CallbackGenericService others_;  // gRPC starts no server without a service
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

TEST(Tls, FilesWrittenInPlaceOneByOneAreServedWhenTheyFit) {
  const CertificateAuthority authority("authority");
  const CertifiedKey first = authority.Issue("first"), second = authority.Issue("second");
  const testing::TemporaryFolder folder;
  const std::string certificate = folder.Write("server.pem", first.certificate);
  const std::string key = folder.Write("server.key", first.key);
  HealthServer server({certificate, key, "", kReloadInterval});
  const std::string& root = authority.certificate();
  ASSERT_TRUE(server.TurnsTo("first", root));

  Write(certificate, second.certificate.substr(0, second.certificate.size() / 2));
  ASSERT_TRUE(server.log().Has("breaks off"));
  EXPECT_EQ(server.Check(root).server_name, "first");
  Write(certificate, second.certificate);
  ASSERT_TRUE(server.log().Has("not the key"));
  EXPECT_EQ(server.Check(root).server_name, "first");
  Write(key, second.key.substr(0, second.key.size() / 2));
  ASSERT_TRUE(server.log().Has("no private key"));
  EXPECT_EQ(server.Check(root).server_name, "first");
  std::filesystem::remove(key);
  ASSERT_TRUE(server.log().Has("no such file"));
  EXPECT_EQ(server.Check(root).server_name, "first");
  Write(key, second.key);
  EXPECT_TRUE(server.TurnsTo("second", root));
  EXPECT_EQ(server.log().Count("info: serves certificate \"second\""), 1);
}

// As certificate managers do: the folder of the files changes behind a link.
TEST(Tls, FilesBehindASwitchedLinkAreServed) {
  const CertificateAuthority authority("authority");
  const testing::TemporaryFolder folder;
  for (const std::string name : {"first", "second"}) {
    const CertifiedKey issued = authority.Issue(name);
    std::filesystem::create_directory(folder.File(name));
    folder.Write(name + "/server.pem", issued.certificate);
    folder.Write(name + "/server.key", issued.key);
  }
  std::filesystem::create_symlink("first", folder.File("current"));
  HealthServer server(
      {folder.File("current/server.pem"), folder.File("current/server.key"), "", kReloadInterval});
  ASSERT_TRUE(server.TurnsTo("first", authority.certificate()));
  std::filesystem::create_symlink("second", folder.File("next"));
  std::filesystem::rename(folder.File("next"), folder.File("current"));
  EXPECT_TRUE(server.TurnsTo("second", authority.certificate()));
  EXPECT_EQ(server.log().Count("warning"), 0);
}

// Both files are rewritten all the time, by halves and in either order, as four threads call.
TEST(Tls, NoCallFailsUnderConstantRotation) {
  constexpr int kNumRotations = 60;
  const CertificateAuthority authority("authority");
  const CertifiedKey pairs[] = {authority.Issue("even"), authority.Issue("odd")};
  const testing::TemporaryFolder folder;
  const std::string certificate = folder.Write("server.pem", pairs[0].certificate);
  const std::string key = folder.Write("server.key", pairs[0].key);
  HealthServer server({certificate, key, "", absl::Milliseconds(1)});
  std::vector<std::jthread> callers;
  for (int i = 0; i < 4; ++i) {
    callers.emplace_back([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const auto answer = server.Check(authority.certificate());
        EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
      }
    });
  }
  for (int i = 0; i < kNumRotations; ++i) {
    const auto& [new_certificate, new_key] = pairs[i % 2];
    if (i % 3 == 0) Write(certificate, new_certificate.substr(0, new_certificate.size() / 3));
    if (i % 4 < 2) Write(key, new_key);
    absl::SleepFor(absl::Milliseconds(20));
    Write(certificate, new_certificate);
    absl::SleepFor(absl::Milliseconds(20));
    Write(key, new_key);
    absl::SleepFor(absl::Milliseconds(10));
  }
  callers.clear();
  EXPECT_TRUE(server.TurnsTo("odd", authority.certificate()));
}

TEST(Tls, ClientsThatTrustAnotherAuthorityDoNotConnect) {
  const CertificateAuthority authority("authority"), other("other");
  const testing::TemporaryFolder folder;
  const CertifiedKey issued = authority.Issue("server");
  HealthServer server({folder.Write("server.pem", issued.certificate),
                       folder.Write("server.key", issued.key),
                       "",
                       kReloadInterval});
  EXPECT_TRUE(server.Check(authority.certificate()).status.ok());
  EXPECT_EQ(server.Check(other.certificate()).status.error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST(Tls, MutualTlsLetsClientsOfTheAuthorityInAndFollowsIt) {
  const CertificateAuthority authority("authority"), studio("studio"), farm("farm");
  const testing::TemporaryFolder folder;
  const CertifiedKey issued = authority.Issue("server");
  const std::string clients = folder.Write("clients.pem", studio.certificate());
  HealthServer server({folder.Write("server.pem", issued.certificate),
                       folder.Write("server.key", issued.key),
                       clients,
                       kReloadInterval});
  const std::string& root = authority.certificate();
  const CertifiedKey of_studio = studio.Issue("artist"), of_farm = farm.Issue("node");
  EXPECT_TRUE(server.Check(root, of_studio).status.ok());
  EXPECT_EQ(server.Check(root).status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(server.Check(root, of_farm).status.error_code(), grpc::StatusCode::UNAVAILABLE);

  Write(clients, studio.certificate() + farm.certificate());
  const absl::Time deadline = absl::Now() + kPatience;
  while (!server.Check(root, of_farm).status.ok() && absl::Now() < deadline) {
    absl::SleepFor(absl::Milliseconds(100));
    EXPECT_TRUE(server.Check(root, of_studio).status.ok());
  }
  EXPECT_TRUE(server.Check(root, of_farm).status.ok());
  EXPECT_TRUE(server.Check(root, of_studio).status.ok());
  EXPECT_FALSE(server.Check(root).status.ok());
}

TEST(Tls, ARefusalIsLoggedOnce) {
  const CertificateAuthority authority("authority");
  const CertifiedKey issued = authority.Issue("server");
  const testing::TemporaryFolder folder;
  const std::string certificate = folder.Write("server.pem", issued.certificate);
  const std::string key = folder.Write("server.key", issued.key);
  Log log;
  const auto credentials =
      ReloadingCredentials::Start({certificate, key, "", absl::Milliseconds(1)}, log.Writer());
  ASSERT_TRUE(credentials.ok()) << credentials.status();
  Write(key, authority.Issue("other").key);
  ASSERT_TRUE(log.Has("not the key"));
  absl::SleepFor(absl::Milliseconds(50));
  EXPECT_EQ(log.Count("not the key"), 1);
}

TEST(Tls, ExpiredCertificatesAreServedWithAWarning) {
  const CertificateAuthority authority("authority");
  const absl::Time now = absl::Now();
  const CertifiedKey issued =
      authority.Issue("late", {now - absl::Hours(48), now - absl::Hours(24)});
  const testing::TemporaryFolder folder;
  Log log;
  const auto credentials =
      ReloadingCredentials::Start({folder.Write("server.pem", issued.certificate),
                                   folder.Write("server.key", issued.key),
                                   "",
                                   kReloadInterval},
                                  log.Writer());
  ASSERT_TRUE(credentials.ok()) << credentials.status();
  EXPECT_EQ(log.Count("warning: certificate \"late\""), 1);
  EXPECT_EQ(log.Count("expired on"), 1);
}

TEST(Tls, BadFilesAndIntervalsFailAtTheStart) {
  const testing::TemporaryFolder folder;
  Log log;
  const std::string missing = folder.File("server.pem");
  EXPECT_TRUE(
      HasAll(ReloadingCredentials::Start({missing, missing, ""}, log.Writer()).status().message(),
             {missing, "no such file"}));
  EXPECT_TRUE(
      HasAll(ReloadingCredentials::Start({missing, missing, "", absl::ZeroDuration()}, log.Writer())
                 .status()
                 .message(),
             {"interval = 0", "more than 0"}));
}

}  // namespace
}  // namespace lightfit
