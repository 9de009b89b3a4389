// SPDX-License-Identifier: MIT
#include "peer_bench/columns.hpp"

#include <cblas-openblas.h>
#include <faiss/IndexFlat.h>
#include <faiss/IndexHNSW.h>
#include <omp.h>

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <utility>

#include "seqloop/difference.hpp"

namespace seqloop::peers {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// FAISS keeps its rows without padding.
void add_rows(faiss::Index& index, const program::ColumnData& data) {
  const std::size_t stride = padded_size(data.size.descriptor_size);
  if (stride == data.size.descriptor_size) {
    index.add(static_cast<faiss::Index::idx_t>(data.size.places), data.rows.data());
    return;
  }
  for (std::size_t row = 0; row < data.size.places; ++row) {
    index.add(1, data.rows.data() + row * stride);
  }
}

/// Looks for the place that is nearest to the query.
std::function<void()> search_by(std::shared_ptr<const faiss::Index> index,
                                std::span<const float> query) {
  return [index = std::move(index), query] {
    float distance = 0.0F;
    faiss::Index::idx_t nearest = 0;
    index->search(1, query.data(), 1, &distance, &nearest);
  };
}

}  // namespace

std::vector<program::Contender> columns(const program::ColumnData& data) {
  openblas_set_num_threads(1);
  omp_set_num_threads(1);
  const std::size_t places = data.size.places;
  const std::size_t size = data.size.descriptor_size;
  const std::size_t stride = padded_size(size);
  const auto out = std::make_shared<Eigen::VectorXf>(static_cast<Eigen::Index>(places));
  std::vector<program::Contender> contenders;
  const auto add = [&](std::string by, std::function<void()> round) {
    contenders.push_back(
        {"column", std::move(by), places, size, places * size * sizeof(float), std::move(round)});
  };
  add("eigen-gemv", [=] {
    const auto columns = static_cast<Eigen::Index>(stride);
    const Eigen::Map<const Matrix> rows(data.rows.data(), static_cast<Eigen::Index>(places),
                                        columns);
    const Eigen::Map<const Eigen::VectorXf> query(data.query.data(), columns);
    out->noalias() = rows * query;
  });
  add("openblas-sgemv", [=] {
    cblas_sgemv(CblasRowMajor, CblasNoTrans, static_cast<blasint>(places),
                static_cast<blasint>(size), 1.0F, data.rows.data(), static_cast<blasint>(stride),
                data.query.data(), 1, 0.0F, out->data(), 1);
  });
  const auto width = static_cast<faiss::Index::idx_t>(size);
  const auto flat = std::make_shared<faiss::IndexFlatL2>(width);
  add_rows(*flat, data);
  add("faiss-flat", search_by(flat, data.query));
  if (data.graph) {
    constexpr int links = 32;
    const auto graph = std::make_shared<faiss::IndexHNSWFlat>(width, links);
    add_rows(*graph, data);
    add("faiss-hnsw32", search_by(graph, data.query));
    // It looks at this many places at least.
    contenders.back().bytes = static_cast<std::size_t>(graph->hnsw.efSearch) * size * sizeof(float);
  }
  return contenders;
}

}  // namespace seqloop::peers
