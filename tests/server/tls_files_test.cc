#include "server/tls_files.h"

#include <gtest/gtest.h>

#include "tests/io/testing.h"
#include "tests/server/certificates.h"

namespace lightfit {
namespace {

using testing::CertificateAuthority;
using testing::CertifiedKey;
using testing::HasAll;

constexpr char kCertificatePath[] = "server.pem", kKeyPath[] = "server.key", kCaPath[] = "ca.pem";
const TlsOptions kServer = {kCertificatePath, kKeyPath, ""};
const TlsOptions kMutual = {kCertificatePath, kKeyPath, kCaPath};

TEST(TlsFiles, ConsistentFilesGiveNameAndDates) {
  const CertificateAuthority authority("authority");
  const absl::Time day = absl::FromTimeT(2000000000);
  const CertifiedKey server = authority.Issue("node 7", {day, day + absl::Hours(10)});
  const auto certificate = CheckTlsFiles(
      kMutual, {server.certificate + authority.certificate(), server.key, authority.certificate()});
  ASSERT_TRUE(certificate.ok()) << certificate.status();
  EXPECT_EQ(certificate->name, "node 7");
  EXPECT_EQ(certificate->not_before, day);
  EXPECT_EQ(certificate->not_after, day + absl::Hours(10));
}

TEST(TlsFiles, AnotherKeyIsRefused) {
  const CertificateAuthority authority("authority");
  const std::string other_key = authority.Issue("b").key;
  const auto certificate =
      CheckTlsFiles(kServer, {authority.Issue("a").certificate, other_key, ""});
  EXPECT_TRUE(HasAll(certificate.status().message(), {kKeyPath, "not the key", kCertificatePath}))
      << certificate.status();
}

// What a reader may find while another program writes. A chain that breaks off between two
// certificates looks whole, and cannot be told from a shorter one.
TEST(TlsFiles, FilesThatBreakOffAnywhereAreRefused) {
  const CertificateAuthority authority("authority");
  const CertifiedKey server = authority.Issue("server");
  const std::string chain = server.certificate + authority.certificate();
  const size_t end_of_first = server.certificate.size() - 1;  // without the end of the line
  for (size_t size = 0; size + 1 < chain.size(); ++size) {
    const bool is_between = size >= end_of_first && size < end_of_first + 1 + 11;  // -----BEGIN_
    if (is_between) continue;
    EXPECT_FALSE(CheckTlsFiles(kServer, {chain.substr(0, size), server.key, ""}).ok()) << size;
  }
  for (size_t size = 0; size + 1 < server.key.size(); ++size) {
    EXPECT_FALSE(CheckTlsFiles(kServer, {chain, server.key.substr(0, size), ""}).ok()) << size;
  }
  const std::string& ca = authority.certificate();
  for (size_t size = 0; size + 1 < ca.size(); ++size) {
    EXPECT_FALSE(CheckTlsFiles(kMutual, {chain, server.key, ca.substr(0, size)}).ok()) << size;
  }
  EXPECT_TRUE(CheckTlsFiles(kMutual, {chain, server.key, ca}).ok());
}

TEST(TlsFiles, RefusalsNameTheFileAndTheWayOut) {
  const CertificateAuthority authority("authority");
  const auto [certificate, key] = authority.Issue("server");
  const auto message = [](const TlsFiles& files) {
    return std::string(CheckTlsFiles(kMutual, files).status().message());
  };
  const std::string& ca = authority.certificate();
  EXPECT_TRUE(HasAll(message({"", key, ca}), {kCertificatePath, "no certificate", "want PEM"}));
  EXPECT_TRUE(HasAll(message({key, key, ca}), {kCertificatePath, "no certificate"}));
  EXPECT_TRUE(HasAll(message({certificate, certificate, ca}), {kKeyPath, "no private key"}));
  EXPECT_TRUE(HasAll(message({certificate, testing::Encrypted(key, "pass"), ca}),
                     {kKeyPath, "encrypted", "without password"}));
  EXPECT_TRUE(HasAll(message({certificate, key, ""}), {kCaPath, "no certificate"}));
  std::string damaged = ca;
  damaged[damaged.size() / 2] = '!';
  EXPECT_TRUE(HasAll(message({certificate, key, damaged}), {kCaPath, "certificate 1"}));
}

TEST(TlsFiles, MissingFilesAreNamed) {
  const testing::TemporaryFolder folder;
  const std::string certificate = folder.Write("a.pem", "x"), key = folder.File("b.key");
  EXPECT_TRUE(
      HasAll(ReadTlsFiles({certificate, key, ""}).status().message(), {key, "no such file"}));
  folder.Write("b.key", "y");
  const auto files = ReadTlsFiles({certificate, key, ""});
  ASSERT_TRUE(files.ok()) << files.status();
  EXPECT_EQ(*files, (TlsFiles{"x", "y", ""}));
}

TEST(TlsFiles, DatesAreToldAWeekAhead) {
  const absl::Time start = absl::FromTimeT(2000000000);  // 2033-05-18 03:33:20 UTC
  const TlsCertificate certificate = {"a", start, start + absl::Hours(24 * 30)};
  EXPECT_EQ(DateWarning(certificate, start - absl::Seconds(1)),
            "is not valid before 2033-05-18 03:33:20 UTC");
  EXPECT_EQ(DateWarning(certificate, start), "");
  EXPECT_EQ(DateWarning(certificate, start + absl::Hours(24 * 22)), "");
  EXPECT_EQ(DateWarning(certificate, start + absl::Hours(24 * 24)),
            "expires on 2033-06-17 03:33:20 UTC");
  EXPECT_EQ(DateWarning(certificate, start + absl::Hours(24 * 31)),
            "expired on 2033-06-17 03:33:20 UTC");
}

}  // namespace
}  // namespace lightfit
