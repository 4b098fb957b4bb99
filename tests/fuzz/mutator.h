// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace earshot::test {

/// Changes seeds at random: bits, bytes, numbers, whole stretches, tokens of a dictionary, parts of
/// other seeds. A mutation is a function of the seeds, the tokens and its number alone.
class Mutator {
public:
    /// Precondition: there is a seed.
    Mutator(std::vector<std::string> seeds, std::vector<std::string> tokens);

    /// Mutation `number`, of the seed `number` modulo the number of seeds.
    std::string mutated(std::uint64_t number) const;

private:
    std::vector<std::string> seeds_;
    std::vector<std::string> tokens_;
};

}  // namespace earshot::test
