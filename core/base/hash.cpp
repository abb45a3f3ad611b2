// SPDX-License-Identifier: Apache-2.0
#include "core/base/hash.h"
#include <openssl/evp.h>

namespace lightloom {

struct Sha256::State {
    EVP_MD_CTX* context = EVP_MD_CTX_new();
    ~State() { EVP_MD_CTX_free(context); }
};

Sha256::Sha256() : state_(std::make_unique<State>()) { EVP_DigestInit_ex(state_->context, EVP_sha256(), nullptr); }
Sha256::~Sha256() = default;

Sha256& Sha256::add(const void* bytes, std::size_t count)
{
    EVP_DigestUpdate(state_->context, bytes, count);
    return *this;
}

Sha256& Sha256::add(const std::string& text)
{
    add(static_cast<std::uint64_t>(text.size()));
    return add(text.data(), text.size());
}

Sha256::Digest Sha256::finish()
{
    Digest digest;
    EVP_DigestFinal_ex(state_->context, digest.data(), nullptr);
    return digest;
}

std::string toHex(std::span<const std::uint8_t> bytes)
{
    static constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    text.reserve(bytes.size() * 2);
    for (const std::uint8_t b : bytes) {
        text += kDigits[b >> 4];
        text += kDigits[b & 15];
    }
    return text;
}

} // namespace lightloom
