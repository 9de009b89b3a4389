// SPDX-License-Identifier: MIT
#include "peer_bench/matrices.hpp"

#include <cblas-openblas.h>

#include <memory>

#include "seqloop/difference.hpp"

namespace seqloop::peers {

std::vector<program::Contender> matrices(const program::MatrixData& data) {
  openblas_set_num_threads(1);
  const std::size_t places = data.size.places;
  const auto out = std::make_shared<std::vector<float>>(places * places);
  const auto multiply = [=] {
    const auto count = static_cast<blasint>(places);
    const auto stride = static_cast<blasint>(padded_size(data.size.descriptor_size));
    cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, count, count,
                static_cast<blasint>(data.size.descriptor_size), 1.0F, data.queries.data(), stride,
                data.rows.data(), stride, 0.0F, out->data(), count);
  };
  return {{"matrix", "openblas-sgemm", places, data.size.descriptor_size,
           data.queries.size_bytes() + data.rows.size_bytes(), multiply}};
}

}  // namespace seqloop::peers
