// What OpenSubdiv makes of its regression shapes, for Karui's tests to compare with.
//
//   bash tools/osd_oracle/build.sh            builds ./osd_oracle beside this file
//   osd_oracle fixture OUT.bin SHAPE.obj LEVELS   everything, level by level (below)
//   osd_oracle time SEGMENTS SIDES LEVEL [RUNS]   times a torus of quads
//
// OUT.bin is little-endian: "KOSD", u32 levels, u32 face-varying rules (0 or 6), then for
// every level from 1: u32 vertices, faces, corners; u32 corners of every face; u32 vertex of
// every corner; u8 hole of every face; f64 position, limit position, limit normal of every
// vertex; then for every rule (none, corners only, plus 1, plus 2, boundaries, all) f64
// u v of every corner.
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <cmath>
#include <ctime>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

using namespace OpenSubdiv;
typedef Far::TopologyDescriptor Descriptor;
typedef Far::TopologyRefinerFactory<Descriptor> Factory;
typedef std::unique_ptr<Far::TopologyRefiner> Refiner;

template <class REAL, int N> struct Value {
    REAL x[N];
    void Clear(void * = 0) { for (REAL & c : x) c = 0; }
    void AddWithWeight(Value const & v, REAL w) {
        for (int i = 0; i < N; ++i) x[i] += w * v.x[i];
    }
};
typedef Value<double, 3> P;
typedef Value<double, 2> UV;

struct Shape {
    Sdc::SchemeType scheme = Sdc::SCHEME_CATMARK;
    Sdc::Options options;
    std::vector<P> positions;
    std::vector<UV> uvs;
    std::vector<int> sizes, corners, corner_uvs, creases, sharp, holes;
    std::vector<float> crease_weights, sharp_weights;

    Refiner refine(Sdc::Options with, int levels) const {
        Descriptor d;
        d.numVertices = (int)positions.size();
        d.numFaces = (int)sizes.size();
        d.numVertsPerFace = sizes.data();
        d.vertIndicesPerFace = corners.data();
        d.numCreases = (int)crease_weights.size();
        d.creaseVertexIndexPairs = creases.data();
        d.creaseWeights = crease_weights.data();
        d.numCorners = (int)sharp.size();
        d.cornerVertexIndices = sharp.data();
        d.cornerWeights = sharp_weights.data();
        d.numHoles = (int)holes.size();
        d.holeIndices = holes.data();
        Descriptor::FVarChannel channel;
        channel.numValues = (int)uvs.size();
        channel.valueIndices = corner_uvs.data();
        bool has_uvs = corner_uvs.size() == corners.size();
        d.numFVarChannels = has_uvs ? 1 : 0;
        d.fvarChannels = &channel;
        Refiner refiner(Factory::Create(d, Factory::Options(scheme, with)));
        if (!refiner) { std::fprintf(stderr, "refused\n"); std::exit(1); }
        Far::TopologyRefiner::UniformOptions uniform(levels);
        uniform.fullTopologyInLastLevel = true;
        refiner->RefineUniform(uniform);
        return refiner;
    }
};

static void tag(Shape & shape, std::istringstream & line) {
    std::string name, counts;
    line >> name >> counts;
    int n[3] = {0, 0, 0};
    std::sscanf(counts.c_str(), "%d/%d/%d", n, n + 1, n + 2);
    std::vector<int> ints(n[0]);
    std::vector<float> floats(n[1]);
    std::string text;
    for (int & i : ints) line >> i;
    for (float & f : floats) line >> f;
    if (n[2]) line >> text;
    if (name == "crease") {
        shape.creases.insert(shape.creases.end(), ints.begin(), ints.begin() + 2);
        shape.crease_weights.push_back(floats[0]);
    } else if (name == "corner") {
        shape.sharp.push_back(ints[0]);
        shape.sharp_weights.push_back(floats[0]);
    } else if (name == "hole") {
        shape.holes.insert(shape.holes.end(), ints.begin(), ints.end());
    } else if (name == "interpolateboundary") {
        Sdc::Options::VtxBoundaryInterpolation by[] = {Sdc::Options::VTX_BOUNDARY_NONE,
            Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER, Sdc::Options::VTX_BOUNDARY_EDGE_ONLY};
        shape.options.SetVtxBoundaryInterpolation(by[ints[0]]);
    } else if (name == "creasemethod" && text == "chaikin") {
        shape.options.SetCreasingMethod(Sdc::Options::CREASE_CHAIKIN);
    } else if (name == "smoothtriangles" && text == "smooth") {
        shape.options.SetTriangleSubdivision(Sdc::Options::TRI_SUB_SMOOTH);
    }
}

static Shape read(std::string const & path) {
    Shape shape;
    std::string file = path.substr(path.rfind('/') + 1);
    if (file.rfind("loop", 0) == 0) shape.scheme = Sdc::SCHEME_LOOP;
    if (file.rfind("bilinear", 0) == 0) shape.scheme = Sdc::SCHEME_BILINEAR;
    shape.options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    std::ifstream in(path);
    for (std::string text; std::getline(in, text);) {
        std::istringstream line(text);
        std::string word;
        line >> word;
        if (word == "v") {
            // As Karui stores them.
            float x, y, z;
            line >> x >> y >> z;
            shape.positions.push_back(P{{x, y, z}});
        } else if (word == "vt") {
            float u, v;
            line >> u >> v;
            shape.uvs.push_back(UV{{u, v}});
        } else if (word == "f") {
            int size = 0;
            while (line >> word) {
                ++size;
                shape.corners.push_back(std::atoi(word.c_str()) - 1);
                size_t slash = word.find('/');
                if (slash != std::string::npos && word[slash + 1] != '/')
                    shape.corner_uvs.push_back(std::atoi(word.c_str() + slash + 1) - 1);
            }
            shape.sizes.push_back(size);
        } else if (word == "t") {
            tag(shape, line);
        }
    }
    return shape;
}

template <class T> void put(std::ofstream & out, T const * data, size_t count) {
    out.write((char const *)data, sizeof(T) * count);
}
static void put32(std::ofstream & out, uint32_t value) { put(out, &value, 1); }

// The values of every level from 1.
template <class T, class STEP>
std::vector<std::vector<T>> levels_of(std::vector<T> from, int levels, STEP step) {
    std::vector<std::vector<T>> all;
    for (int level = 1; level <= levels; ++level) {
        all.push_back(step(level, from));
        from = all.back();
    }
    return all;
}

static int fixture(std::string const & to, std::string const & path, int levels) {
    Shape shape = read(path);
    Refiner refiner = shape.refine(shape.options, levels);
    Far::PrimvarRefinerReal<double> primvar(*refiner);
    auto positions = levels_of(shape.positions, levels, [&](int level, std::vector<P> & from) {
        std::vector<P> to(refiner->GetLevel(level).GetNumVertices());
        primvar.Interpolate(level, from, to);
        return to;
    });
    Sdc::Options::FVarLinearInterpolation rules[] = {Sdc::Options::FVAR_LINEAR_NONE,
        Sdc::Options::FVAR_LINEAR_CORNERS_ONLY, Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1,
        Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2, Sdc::Options::FVAR_LINEAR_BOUNDARIES,
        Sdc::Options::FVAR_LINEAR_ALL};
    bool has_uvs = !shape.uvs.empty() && shape.corner_uvs.size() == shape.corners.size();
    std::vector<std::vector<std::vector<double>>> corner_uvs(levels);
    for (auto rule : rules) {
        if (!has_uvs) break;
        Sdc::Options with = shape.options;
        with.SetFVarLinearInterpolation(rule);
        Refiner fine = shape.refine(with, levels);
        Far::PrimvarRefinerReal<double> refine(*fine);
        auto uvs = levels_of(shape.uvs, levels, [&](int level, std::vector<UV> & from) {
            std::vector<UV> to(fine->GetLevel(level).GetNumFVarValues(0));
            refine.InterpolateFaceVarying(level, from, to, 0);
            return to;
        });
        for (int level = 1; level <= levels; ++level) {
            Far::TopologyLevel const & l = fine->GetLevel(level);
            std::vector<double> flat;
            for (int f = 0; f < l.GetNumFaces(); ++f)
                for (int i : l.GetFaceFVarValues(f, 0))
                    for (double c : uvs[level - 1][i].x) flat.push_back(c);
            corner_uvs[level - 1].push_back(flat);
        }
    }
    std::ofstream out(to, std::ios::binary);
    put(out, "KOSD", 4);
    put32(out, levels);
    put32(out, has_uvs ? 6 : 0);
    for (int level = 1; level <= levels; ++level) {
        Far::TopologyLevel const & l = refiner->GetLevel(level);
        std::vector<P> const & at = positions[level - 1];
        put32(out, l.GetNumVertices());
        put32(out, l.GetNumFaces());
        put32(out, l.GetNumFaceVertices());
        for (int f = 0; f < l.GetNumFaces(); ++f) put32(out, l.GetFaceVertices(f).size());
        for (int f = 0; f < l.GetNumFaces(); ++f)
            for (int v : l.GetFaceVertices(f)) put32(out, v);
        for (int f = 0; f < l.GetNumFaces(); ++f) {
            uint8_t hole = l.IsFaceHole(f);
            put(out, &hole, 1);
        }
        put(out, at.data(), at.size());
        // Limits are asked of a refiner that ends at this level.
        Refiner last = shape.refine(shape.options, level);
        std::vector<P> limit(at.size()), t1(at.size()), t2(at.size());
        Far::PrimvarRefinerReal<double> limits(*last);
        // OpenSubdiv 3.5 writes past its weights for tangents where an edge has many faces.
        if (path.find("nonman") == std::string::npos) limits.Limit(at, limit, t1, t2);
        else limits.Limit(at, limit);
        for (size_t v = 0; v < at.size(); ++v) {
            double const *a = t1[v].x, *b = t2[v].x;
            P n{{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
            double length = std::sqrt(n.x[0] * n.x[0] + n.x[1] * n.x[1] + n.x[2] * n.x[2]);
            for (double & c : n.x) c = length > 0 ? c / length : 0;
            t1[v] = n;
        }
        put(out, limit.data(), limit.size());
        put(out, t1.data(), t1.size());
        for (std::vector<double> const & uvs : corner_uvs[level - 1])
            put(out, uvs.data(), uvs.size());
    }
    return out.good() ? 0 : 1;
}

// Milliseconds of the processor: other work on the machine does not count.
typedef std::clock_t Time;
static double since(Time start) { return 1e3 * double(std::clock() - start) / CLOCKS_PER_SEC; }

static int times(int segments, int sides, int levels, int runs) {
    typedef Value<float, 3> F;
    Shape shape;
    std::vector<F> cage;
    for (int j = 0; j < sides; ++j)
        for (int i = 0; i < segments; ++i) {
            double u = 2 * M_PI * i / segments, v = 2 * M_PI * j / sides;
            double r = 1 + 0.4 * std::cos(v);
            P p{{r * std::cos(u), 0.4 * std::sin(v), -r * std::sin(u)}};
            shape.positions.push_back(p);
            cage.push_back(F{{(float)p.x[0], (float)p.x[1], (float)p.x[2]}});
            int next = (j + 1) % sides, right = (i + 1) % segments;
            shape.sizes.push_back(4);
            for (int c : {j * segments + i, j * segments + right, next * segments + right,
                          next * segments + i})
                shape.corners.push_back(c);
        }
    for (int run = 0; run < runs; ++run) {
        Time start = std::clock();
        Descriptor d;
        d.numVertices = (int)shape.positions.size();
        d.numFaces = (int)shape.sizes.size();
        d.numVertsPerFace = shape.sizes.data();
        d.vertIndicesPerFace = shape.corners.data();
        Refiner refiner(Factory::Create(d, Factory::Options(shape.scheme, shape.options)));
        refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(levels));
        double topology = since(start);
        start = std::clock();
        Far::PrimvarRefiner primvar(*refiner);
        std::vector<F> from = cage;
        for (int level = 1; level <= levels; ++level) {
            std::vector<F> to(refiner->GetLevel(level).GetNumVertices());
            primvar.Interpolate(level, from, to);
            from.swap(to);
        }
        double positions = since(start);
        int faces = refiner->GetLevel(levels).GetNumFaces();
        std::printf("%d faces: topology %.0f ms, positions %.0f ms\n", faces, topology, positions);
        if (run > 0) continue;
        // The finest level from the cage at once.
        start = std::clock();
        Far::StencilTableFactory::Options options;
        options.generateIntermediateLevels = false;
        options.generateOffsets = true;
        std::unique_ptr<Far::StencilTable const> table(
            Far::StencilTableFactory::Create(*refiner, options));
        double build = since(start);
        std::vector<F> to(table->GetNumStencils());
        for (int i = 0; i < 3; ++i) {
            start = std::clock();
            table->UpdateValues(cage.data(), to.data());
            std::printf("stencils: build %.0f ms, apply %.0f ms\n", build, since(start));
        }
    }
    return 0;
}

int main(int count, char ** args) {
    std::string what = count > 1 ? args[1] : "";
    if (what == "fixture" && count == 5) return fixture(args[2], args[3], std::atoi(args[4]));
    if (what == "time" && count >= 5)
        return times(std::atoi(args[2]), std::atoi(args[3]), std::atoi(args[4]),
                     count > 5 ? std::atoi(args[5]) : 3);
    std::fprintf(stderr, "osd_oracle fixture OUT.bin SHAPE.obj LEVELS | time SEGMENTS SIDES LEVEL\n");
    return 2;
}
