#include "rivals/columns.hpp"

#include <cblas-openblas.h>
#include <faiss/IndexFlat.h>
#include <omp.h>

#include <Eigen/Core>
#include <memory>
#include <utility>

#include "seqloop/difference.hpp"

namespace seqloop::rivals {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// FAISS keeps its rows without padding.
std::shared_ptr<faiss::IndexFlatL2> indexed(const program::ColumnData& data) {
  const std::size_t size = data.size.descriptor_size;
  const std::size_t stride = padded_size(size);
  auto index = std::make_shared<faiss::IndexFlatL2>(static_cast<faiss::Index::idx_t>(size));
  for (std::size_t row = 0; row < data.size.places; ++row) {
    index->add(1, data.rows.data() + row * stride);
  }
  return index;
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
    const auto width = static_cast<Eigen::Index>(stride);
    const Eigen::Map<const Matrix> rows(data.rows.data(), static_cast<Eigen::Index>(places), width);
    const Eigen::Map<const Eigen::VectorXf> query(data.query.data(), width);
    out->noalias() = rows * query;
  });
  add("openblas-sgemv", [=] {
    cblas_sgemv(CblasRowMajor, CblasNoTrans, static_cast<blasint>(places),
                static_cast<blasint>(size), 1.0F, data.rows.data(), static_cast<blasint>(stride),
                data.query.data(), 1, 0.0F, out->data(), 1);
  });
  add("faiss-flat", [=, index = indexed(data)] {
    float distance = 0.0F;
    faiss::Index::idx_t nearest = 0;
    index->search(1, data.query.data(), 1, &distance, &nearest);
    (*out)[0] = distance;
  });
  return contenders;
}

}  // namespace seqloop::rivals
