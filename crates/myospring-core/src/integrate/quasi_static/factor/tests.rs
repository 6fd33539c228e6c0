use super::super::nearby;
use super::*;
use crate::interruption::Interruption;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::material::{assemble, default_material};
use crate::mechanics::support::SupportKind;
use crate::mechanics::{Configuration, largest, zeros};
use crate::mesh::{built_in, lattice};
use proptest::prelude::*;

type Free = [Vec<bool>; 2];

fn all_free(count: usize) -> Free {
    [vec![true; count], vec![true; count]]
}

/// Forces on all coordinates, fixed and irregular.
fn some_forces(count: usize) -> Vectors {
    [0, 1]
        .map(|axis| (0..count).map(|i| ((2 * i + axis) as f64 * 0.618_034).fract() - 0.5).collect())
}

/// A chain of springs of unit stiffness along x, stiffness 2 across.
fn chain(count: usize) -> (Vectors, StiffnessMatrix) {
    let mut stiffness = StiffnessMatrix::new(count);
    for node in 1..count {
        stiffness.add_pair(node - 1, node, [[1.0, 0.0], [0.0, 2.0]]);
    }
    ([(0..count).map(|i| i as f64).collect(), vec![0.0; count]], stiffness)
}

/// Those nodes of a grid that are kept, a spring to each of the eight neighbours, on a soft bed.
fn grid(
    width: usize,
    height: usize,
    keep: impl Fn(f64, f64) -> bool,
) -> (Vectors, StiffnessMatrix) {
    let mut positions = zeros(0);
    let mut numbers = vec![None; width * height];
    for row in 0..height {
        for column in 0..width {
            if keep(column as f64, row as f64) {
                numbers[row * width + column] = Some(positions[0].len());
                positions[0].push(column as f64);
                positions[1].push(row as f64);
            }
        }
    }
    let mut stiffness = StiffnessMatrix::new(positions[0].len());
    for row in 0..height {
        for column in 0..width {
            let Some(a) = numbers[row * width + column] else { continue };
            stiffness.add(a, a, [[0.01, 0.0], [0.0, 0.02]]);
            for (right, up, block) in [
                (1, 0, [[1.0, 0.0], [0.0, 0.1]]),
                (0, 1, [[0.1, 0.0], [0.0, 1.0]]),
                (1, 1, [[0.5, 0.4], [0.4, 0.5]]),
                (-1, 1, [[0.5, -0.4], [-0.4, 0.5]]),
            ] {
                let (x, y) = (column.checked_add_signed(right), row + up);
                if let Some(x) = x.filter(|x| *x < width)
                    && y < height
                    && let Some(b) = numbers[y * width + x]
                {
                    stiffness.add_pair(a, b, block);
                }
            }
        }
    }
    (positions, stiffness)
}

/// Forces on free coordinates that a solution leaves unbalanced, against the largest force.
fn residual(stiffness: &StiffnessMatrix, free: &Free, forces: &Vectors, moved: &Vectors) -> f64 {
    let restoring = stiffness.times(moved);
    let (mut off, mut largest) = (0.0_f64, 0.0_f64);
    for axis in 0..2 {
        for node in 0..stiffness.len() {
            if free[axis][node] {
                off = off.max((forces[axis][node] - restoring[axis][node]).abs());
                largest = largest.max(forces[axis][node].abs());
            } else {
                assert_eq!(moved[axis][node], 0.0, "a held coordinate stays");
            }
        }
    }
    off / largest
}

fn check(positions: &Vectors, stiffness: &StiffnessMatrix, free: &Free) {
    let mut factor = Factor::new(free.clone());
    factor.factorise(positions, stiffness, &Interruption::default()).unwrap();
    let forces = some_forces(stiffness.len());
    let off = residual(stiffness, free, &forces, &factor.solve(&forces));
    // Rounding, times the condition of these matrices (below a million).
    assert!(off < 1e-10, "{off:e}");
}

#[test]
fn what_no_memory_holds_is_an_error_that_says_how_much_it_is_and_keeps_what_there_was() {
    let too_many = usize::MAX / 8;
    let all = super::zeros::<f64>(too_many).unwrap_err();
    assert_eq!(all, FactorError::TooLarge { bytes: 8 * too_many });
    let mut stack = Stack::default();
    stack.push(3).unwrap().fill(1.0);
    let more = stack.push(too_many - 3).unwrap_err();
    assert_eq!(more, FactorError::TooLarge { bytes: 8 * too_many });
    assert_eq!((stack.top, stack.memory), (3, vec![1.0; 3]));
    let small = FactorError::TooLarge { bytes: 5 };
    assert_eq!(small.beside(7), FactorError::TooLarge { bytes: 12 });
    assert_eq!(FactorError::Indefinite.beside(7), FactorError::Indefinite);
}

#[test]
fn a_chain_held_at_one_end_stretches_as_springs_in_series() {
    for count in [2, 5, 300] {
        let (positions, stiffness) = chain(count);
        let mut free = all_free(count);
        (free[0][0], free[1][0]) = (false, false);
        let mut factor = Factor::new(free);
        factor.factorise(&positions, &stiffness, &Interruption::default()).unwrap();
        let mut forces = zeros(count);
        (forces[0][count - 1], forces[1][count - 1]) = (3.0, 4.0);
        // What pulls at a held node moves nothing.
        forces[0][0] = 7.0;
        let moved = factor.solve(&forces);
        for node in 0..count {
            // Rounding times the condition of the longest chain, some 1e5.
            let allowed = 1e-10 * node as f64;
            assert!((moved[0][node] - 3.0 * node as f64).abs() <= allowed);
            assert!((moved[1][node] - 2.0 * node as f64).abs() <= allowed);
        }
    }
}

#[test]
fn a_negative_spring_is_found_out_and_a_mended_one_is_factorised() {
    let positions = [vec![0.0, 1.0], vec![0.0; 2]];
    let mut factor = Factor::new([vec![false, true], vec![false, true]]);
    let mut stiffness = StiffnessMatrix::new(2);
    stiffness.add_pair(0, 1, [[1.0, 0.0], [0.0, -0.1]]);
    assert_eq!(
        factor.factorise(&positions, &stiffness, &Interruption::default()),
        Err(FactorError::Indefinite)
    );
    stiffness.add_pair(0, 1, [[0.0, 0.0], [0.0, 0.2]]);
    assert_eq!(factor.factorise(&positions, &stiffness, &Interruption::default()), Ok(()));
}

#[test]
fn one_soft_node_anywhere_makes_a_stiffness_indefinite() {
    let (positions, stiffness) = grid(20, 15, |_, _| true);
    for node in [0, 7, 150, 160, 299] {
        for axis in 0..2 {
            let mut block = [[0.0; 2]; 2];
            block[axis][axis] = -10.0;
            let mut soft = stiffness.clone();
            soft.add(node, node, block);
            let mut factor = Factor::new(all_free(300));
            assert_eq!(
                factor.factorise(&positions, &soft, &Interruption::default()),
                Err(FactorError::Indefinite),
                "{node}"
            );
            factor.factorise(&positions, &stiffness, &Interruption::default()).unwrap();
        }
    }
}

#[test]
fn what_is_not_a_number_is_not_positive_definite() {
    let (positions, stiffness) = grid(9, 9, |_, _| true);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (a, b) in [(3, 3), (3, 4), (40, 41)] {
            let mut broken = stiffness.clone();
            broken.add(a, b, [[value, 0.0], [0.0, 0.0]]);
            let mut factor = Factor::new(all_free(81));
            assert_eq!(
                factor.factorise(&positions, &broken, &Interruption::default()),
                Err(FactorError::Indefinite),
                "{value}"
            );
        }
    }
}

#[test]
fn nothing_one_node_and_a_node_without_stiffness() {
    let nothing = zeros(0);
    let mut factor = Factor::new(all_free(0));
    factor.factorise(&nothing, &StiffnessMatrix::new(0), &Interruption::default()).unwrap();
    assert_eq!(factor.solve(&zeros(0)), zeros(0));

    let one = zeros(1);
    let mut stiffness = StiffnessMatrix::new(1);
    let mut factor = Factor::new(all_free(1));
    assert_eq!(
        factor.factorise(&one, &stiffness, &Interruption::default()),
        Err(FactorError::Indefinite)
    );
    stiffness.add(0, 0, [[4.0, 0.0], [0.0, 16.0]]);
    factor.factorise(&one, &stiffness, &Interruption::default()).unwrap();
    assert_eq!(factor.solve(&[vec![1.0], vec![1.0]]), [vec![0.25], vec![0.0625]]);

    let mut held = Factor::new([vec![false], vec![false]]);
    held.factorise(&one, &StiffnessMatrix::new(1), &Interruption::default()).unwrap();
    assert_eq!(held.solve(&[vec![1.0], vec![1.0]]), zeros(1));
}

#[test]
fn strips_round_cells_cells_with_a_hole_and_parts_are_solved() {
    let round = |x: f64, y: f64| (x - 20.0).hypot(y - 20.0) < 20.0;
    let ring = |x: f64, y: f64| round(x, y) && (x - 20.0).hypot(y - 20.0) > 8.0;
    let parts = |x: f64, y: f64| !(10.0..=15.0).contains(&x) && !(20.0..=22.0).contains(&y);
    let shapes = [
        grid(400, 3, |_, _| true),
        grid(2, 300, |_, _| true),
        grid(40, 40, round),
        grid(40, 40, ring),
        grid(40, 40, parts),
        grid(40, 40, |x, y| x % 3.0 == 0.0 && y % 3.0 == 0.0),
    ];
    for (positions, stiffness) in &shapes {
        let mut free = all_free(stiffness.len());
        check(positions, stiffness, &free);
        for node in 0..stiffness.len() {
            free[node % 2][node] = node % 5 != 0;
        }
        check(positions, stiffness, &free);
    }
}

#[test]
fn positions_that_tell_nothing_cost_time_only() {
    let (mut positions, stiffness) = grid(20, 20, |_, _| true);
    for axis in &mut positions {
        axis.fill(1.0);
    }
    check(&positions, &stiffness, &all_free(400));
}

#[test]
fn the_built_in_cell_is_solved_at_rest_and_under_tension() {
    let outline = built_in::adult_ventricular();
    let (mesh, _) = lattice::from_outline(&outline, Some(2.5)).unwrap();
    let fibres = vec![[0.8, 0.6]; mesh.simplices.len()];
    let material = default_material();
    let support = SupportKind::ClampedEnd;
    let (body, system) =
        assemble(&mesh, &material, ActiveLaw::Fibre, &fibres, support, [1.0, 0.0], 140.0);
    let mut free = all_free(mesh.len());
    for node in 0..mesh.len() {
        if body.positions[0][node] < 10.0 {
            (free[0][node], free[1][node]) = (false, false);
        }
    }
    let still = zeros(mesh.len());
    for tension in [0.0, 5.0] {
        let at = Configuration {
            positions: &body.positions,
            velocities: &still,
            tension: tension.into(),
        };
        let mut stiffness = StiffnessMatrix::new(mesh.len());
        for force in system.passive.iter().chain(&system.active) {
            force.add_stiffness(&at, &mut stiffness);
        }
        check(&body.positions, &stiffness, &free);
    }
}

#[test]
fn a_factor_made_again_and_another_have_the_same_bits() {
    let (positions, stiffness) = grid(30, 30, |_, _| true);
    let mut other = stiffness.clone();
    other.add(17, 17, [[1.0, 0.2], [0.2, 3.0]]);
    let forces = some_forces(900);
    let mut factor = Factor::new(all_free(900));
    factor.factorise(&positions, &stiffness, &Interruption::default()).unwrap();
    let first = factor.solve(&forces);
    factor.factorise(&positions, &other, &Interruption::default()).unwrap();
    assert_ne!(factor.solve(&forces), first);
    factor.factorise(&positions, &stiffness, &Interruption::default()).unwrap();
    assert_eq!(factor.solve(&forces), first);
    let mut another = Factor::new(all_free(900));
    another.factorise(&positions, &stiffness, &Interruption::default()).unwrap();
    assert_eq!(another.solve(&forces), first);
}

#[test]
fn nodes_that_meet_later_are_known() {
    let (positions, mut stiffness) = grid(12, 12, |_, _| true);
    let forces = some_forces(144);
    let mut factor = Factor::new(all_free(144));
    factor.factorise(&positions, &stiffness, &Interruption::default()).unwrap();
    stiffness.add_pair(0, 143, [[5.0, 1.0], [1.0, 4.0]]);
    factor.factorise(&positions, &stiffness, &Interruption::default()).unwrap();
    let off = residual(&stiffness, &all_free(144), &forces, &factor.solve(&forces));
    assert!(off < 1e-12, "{off:e}");
}

#[test]
fn the_factor_of_a_square_is_as_sparse_as_nested_dissection_makes_it() {
    let side = 96_usize;
    let (positions, stiffness) = grid(side, side, |_, _| true);
    let mut factor = Factor::new(all_free(side * side));
    factor.factorise(&positions, &stiffness, &Interruption::default()).unwrap();
    // george_1973: 31/4 n^2 log2 n entries for n x n nodes (here four a pair) and a smaller term; banded,
    // it would be n^3.
    let (n, entries) = (side as f64, factor.fronts.as_ref().unwrap().entries as f64);
    assert!(entries < 4.0 * 7.75 * n * n * n.log2(), "{entries}");
}

type Work<'a> = &'a dyn Fn(Eliminate<'_>) -> Result<(), FactorError>;

/// Columns of a definite matrix of this size that were eliminated, and what they leave of the rest, which was 0.
fn eliminated([rows, columns]: [usize; 2], blocks: Blocks, work: Work<'_>) -> [Vec<f64>; 2] {
    let value = |i: usize, j: usize| ((i * 31 + j * 17) as f64 * 0.618_034).fract() - 0.5;
    let mut panel = vec![0.0; rows * columns];
    for j in 0..columns {
        for i in j..rows {
            panel[j * rows + i] = if i == j { 0.4 * rows as f64 } else { value(i, j) };
        }
    }
    let mut rest = vec![0.0; (rows - columns).pow(2)];
    let done = work(Eliminate {
        panel: &mut panel,
        rows,
        columns,
        rest: &mut rest,
        blocks,
        packed: &mut Default::default(),
        interruption: &Interruption::default(),
    });
    assert_eq!(done, Ok(()));
    [panel, rest]
}

#[test]
fn all_vector_units_give_the_same_bits() {
    use pulp::Simd;
    let size = [86, 37];
    let scalar = |work: Eliminate<'_>| pulp::Scalar::new().vectorize(work);
    let expected = eliminated(size, Blocks::SMALL, &scalar);
    assert!(expected == eliminated(size, Blocks::SMALL, &|work| work.run()));
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        assert!(expected == eliminated(size, Blocks::SMALL, &|work| Simd::vectorize(avx2, work)));
    }
}

#[test]
fn large_blocks_give_the_columns_of_small_ones_but_for_rounding() {
    for size in [[86, 37], [128, 128], [700, 300], [560, 130]] {
        let small = eliminated(size, Blocks::SMALL, &|work| work.run());
        let large = eliminated(size, Blocks::LARGE, &|work| work.run());
        for (a, b) in small.iter().flatten().zip(large.iter().flatten()) {
            // All numbers are below 300, and sums of as many terms.
            assert!((a - b).abs() < 1e-11, "{size:?}: {a} {b}");
        }
    }
}

#[test]
fn vector_units_that_fuse_give_the_same_bits_of_large_blocks() {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        use pulp::Simd;
        let size = [300, 190];
        let widest = eliminated(size, Blocks::LARGE, &|work| work.run());
        assert!(widest == eliminated(size, Blocks::LARGE, &|work| Simd::vectorize(avx2, work)));
    }
}

#[test]
fn a_large_rest_has_its_lower_triangle_updated_and_nothing_else() {
    let (rows, columns) = (1250, 20);
    let rest = rows - columns;
    let value = |i: usize, j: usize| ((i * 13 + j * 7) as f64 * 0.618_034).fract() - 0.5;
    // A diagonal block of 1, so that the columns below it stay as they are.
    let mut panel = vec![0.0; rows * columns];
    for j in 0..columns {
        panel[j * rows + j] = 1.0;
        for i in columns..rows {
            panel[j * rows + i] = value(i, j);
        }
    }
    for blocks in [Blocks::SMALL, Blocks::LARGE] {
        let (mut panel, mut left) = (panel.clone(), vec![3.0; rest * rest]);
        let eliminate = Eliminate {
            panel: &mut panel,
            rows,
            columns,
            rest: &mut left,
            blocks,
            packed: &mut Default::default(),
            interruption: &Interruption::default(),
        };
        assert_eq!(eliminate.run(), Ok(()));
        for j in 0..rest {
            for i in 0..rest {
                let taken: f64 = (0..columns)
                    .map(|k| value(columns + i, k) * value(columns + j, k))
                    .filter(|_| i >= j)
                    .sum();
                let off = (left[j * rest + i] - (3.0 - taken)).abs();
                assert!(off < 1e-13, "{i} {j}: {off:e}");
            }
        }
    }
}

/// A block of nodes in space, springs to the neighbours along the axes and across, on a soft bed.
fn block(size: [usize; 3]) -> (Vectors<3>, StiffnessMatrix<3>) {
    let number = |[x, y, z]: [usize; 3]| (z * size[1] + y) * size[0] + x;
    let mut positions = zeros(0);
    let mut stiffness = StiffnessMatrix::new(size.iter().product());
    for at in (0..size[2])
        .flat_map(|z| (0..size[1]).flat_map(move |y| (0..size[0]).map(move |x| [x, y, z])))
    {
        for axis in 0..3 {
            positions[axis].push(at[axis] as f64);
        }
        let bed = [0.01, 0.02, 0.03];
        let mut own = [[0.0; 3]; 3];
        (0..3).for_each(|axis| own[axis][axis] = bed[axis]);
        stiffness.add(number(at), number(at), own);
        for step in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 1, 1]] {
            let to = [0, 1, 2].map(|axis| at[axis] + step[axis]);
            if (0..3).all(|axis| to[axis] < size[axis]) {
                let pull = step.map(|a| step.map(|b| 0.1 + (a * b) as f64));
                let mut pull: [[f64; 3]; 3] = pull;
                (0..3).for_each(|axis| pull[axis][axis] += 0.3);
                stiffness.add_pair(number(at), number(to), pull);
            }
        }
    }
    (positions, stiffness)
}

#[test]
fn a_rounded_factor_of_a_thick_body_leads_to_the_displacements_of_a_whole_one() {
    let (positions, stiffness) = block([14, 11, 9]);
    let count = stiffness.len();
    let mut free = [0, 1, 2].map(|_| vec![true; count]);
    (free[0][0], free[2][7]) = (false, false);
    let forces: Vectors<3> = [0, 1, 2].map(|axis| {
        (0..count).map(|i| ((3 * i + axis) as f64 * 0.618_034).fract() - 0.5).collect()
    });
    let interruption = Interruption::default();
    let mut whole = Factor::whole(free.clone());
    let mut rounded = Factor::new(free);
    for factor in [&mut whole, &mut rounded] {
        factor.is_to_be_costly(true);
        factor.factorise(&positions, &stiffness, &interruption).unwrap();
    }
    assert!(!whole.is_rounded() && rounded.is_rounded());
    let expected = whole.solve(&forces);
    let farthest = |found: &Vectors<3>| {
        let pairs = expected.iter().flatten().zip(found.iter().flatten());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let size = largest(&expected);
    let rough = farthest(&rounded.solve(&forces));
    assert!(rough > 1e-9 * size && rough < 1e-4 * size, "{rough:e} of {size:e}");
    let exact = nearby::solve_by_rounded(&rounded, &stiffness, &forces, 1e-10);
    assert!(farthest(&exact) < 1e-9 * size, "{:e} of {size:e}", farthest(&exact));

    // After one that cannot be made, and made again by one thread, it has the same bits.
    let first = rounded.solve(&forces);
    let mut soft = stiffness.clone();
    soft.add(400, 400, [[-50.0, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
    let failed = rounded.factorise(&positions, &soft, &interruption);
    assert_eq!(failed, Err(FactorError::Indefinite));
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    alone.install(|| rounded.factorise(&positions, &stiffness, &interruption)).unwrap();
    assert!(rounded.solve(&forces) == first);
}

/// Displacements by a plain dense Cholesky factor of the free coordinates; `None` if it is not definite.
fn by_dense_factor(stiffness: &StiffnessMatrix, free: &Free, forces: &Vectors) -> Option<Vectors> {
    let count = stiffness.len();
    let wanted: Vec<(usize, usize)> =
        (0..2 * count).map(|k| (k / 2, k % 2)).filter(|&(node, axis)| free[axis][node]).collect();
    let mut unit = zeros(count);
    let mut lower: Vec<Vec<f64>> = Vec::new();
    for &(node, axis) in &wanted {
        unit[axis][node] = 1.0;
        let column = stiffness.times(&unit);
        unit[axis][node] = 0.0;
        lower.push(wanted.iter().map(|&(node, axis)| column[axis][node]).collect());
    }
    let mut right: Vec<f64> = wanted.iter().map(|&(node, axis)| forces[axis][node]).collect();
    for i in 0..wanted.len() {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let left = lower[i][j] - sum;
            lower[i][j] = if i == j { left.sqrt() } else { left / lower[j][j] };
        }
        if lower[i][i].is_nan() || lower[i][i] <= 0.0 {
            return None;
        }
        let sum: f64 = (0..i).map(|k| lower[i][k] * right[k]).sum();
        right[i] = (right[i] - sum) / lower[i][i];
    }
    let mut moved = zeros(count);
    for i in (0..wanted.len()).rev() {
        let sum: f64 = (i + 1..wanted.len()).map(|k| lower[k][i] * right[k]).sum();
        right[i] = (right[i] - sum) / lower[i][i];
        moved[wanted[i].1][wanted[i].0] = right[i];
    }
    Some(moved)
}

/// Nodes anywhere, blocks between any of them, own stiffness that outweighs them, held coordinates.
fn random_stiffness() -> impl Strategy<Value = (Vectors, StiffnessMatrix, Free)> {
    (1_usize..90).prop_flat_map(|count| {
        let places = || proptest::collection::vec(-50.0..50.0, count);
        let held = || proptest::collection::vec(proptest::bool::weighted(0.9), count);
        let block = proptest::array::uniform4(-1.0..1.0);
        let pairs = proptest::collection::vec((0..count, 0..count, block), 0..4 * count);
        (places(), places(), held(), held(), pairs).prop_map(
            move |(x, y, free_x, free_y, pairs)| {
                let mut stiffness = StiffnessMatrix::new(count);
                for node in 0..count {
                    stiffness.add(node, node, [[0.1, 0.0], [0.0, 0.1]]);
                }
                for (a, b, [xx, xy, yx, yy]) in pairs {
                    if a != b {
                        stiffness.add(a, b, [[xx, xy], [yx, yy]]);
                        let size = xx.abs() + xy.abs() + yx.abs() + yy.abs();
                        for node in [a, b] {
                            stiffness.add(node, node, [[size, 0.0], [0.0, size]]);
                        }
                    }
                }
                ([x, y], stiffness, [free_x, free_y])
            },
        )
    })
}

proptest! {
    #[test]
    fn any_pattern_has_the_solution_of_a_dense_factor(
        (positions, stiffness, free) in random_stiffness(),
    ) {
        let forces = some_forces(stiffness.len());
        let expected = by_dense_factor(&stiffness, &free, &forces);
        prop_assert!(expected.is_some());
        let mut factor = Factor::new(free);
        prop_assert_eq!(factor.factorise(&positions, &stiffness, &Interruption::default()), Ok(()));
        let moved = factor.solve(&forces);
        for (a, b) in moved.iter().flatten().zip(expected.iter().flatten().flatten()) {
            // Eigenvalues lie between 0.1 and some hundreds: rounding times a condition of thousands.
            prop_assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
    }

    #[test]
    fn a_factor_is_found_exactly_where_a_dense_one_is(
        (positions, stiffness, free) in random_stiffness(),
        less in 0.0_f64..3.0,
    ) {
        let mut soft = stiffness;
        for node in 0..soft.len() {
            soft.add(node, node, [[-less, 0.0], [0.0, -less]]);
        }
        let forces = some_forces(soft.len());
        let found = Factor::new(free.clone()).factorise(&positions, &soft, &Interruption::default()).is_ok();
        prop_assert_eq!(found, by_dense_factor(&soft, &free, &forces).is_some());
    }
}
