#include "engine/base/base64.h"

#include <openssl/evp.h>

namespace touchtrace {

std::string base64(const std::vector<std::uint8_t>& bytes) {
  std::vector<unsigned char> text(4 * (bytes.size() / 3 + 1) + 1);
  const int length = EVP_EncodeBlock(text.data(), bytes.data(), static_cast<int>(bytes.size()));
  return {text.begin(), text.begin() + length};
}

}  // namespace touchtrace
