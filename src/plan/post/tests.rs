use super::*;

const SIZE: [u32; 2] = [80, 60];

fn chain(effects: &[PostEffect]) -> PostChain {
    PostChain::new(effects, SIZE[0], SIZE[1])
}

fn tonemap_by(operator: TonemapOperator, exposure: f64) -> PostEffect {
    PostEffect::Tonemap { operator, exposure }
}

fn square(side: usize, centre: f64) -> PostEffect {
    let mut kernel = vec![vec![0.0; side]; side];
    kernel[side / 2][side / 2] = centre;
    PostEffect::Kernel { kernel }
}

#[test]
fn effects_that_change_nothing_vanish() {
    let neutral = [
        PostEffect::Blur { radius: 0.0 },
        PostEffect::Blur { radius: 1e-300 },
        PostEffect::Grayscale { amount: 0.0 },
        PostEffect::Vignette { amount: 0.0 },
        PostEffect::Bloom { threshold: 0.0, intensity: 0.0, radius: 9.0 },
        PostEffect::Sharpen { amount: 0.0 },
        PostEffect::ColorMatrix { matrix: IDENTITY },
        square(1, 1.0),
        square(5, 1.0),
        tonemap_by(TonemapOperator::None, 1.0),
    ];
    for effect in &neutral {
        assert_eq!(chain(std::slice::from_ref(effect)), PostChain::default(), "{effect:?}");
    }
    assert_eq!(chain(&neutral), PostChain::default());
    for effect in [
        PostEffect::Blur { radius: 0.5 },
        PostEffect::Bloom { threshold: 0.0, intensity: 0.1, radius: 0.0 },
        square(1, 0.0),
        square(3, 1.5),
        tonemap_by(TonemapOperator::None, 0.0),
        tonemap_by(TonemapOperator::Aces, 1.0),
    ] {
        assert_ne!(chain(std::slice::from_ref(&effect)), PostChain::default(), "{effect:?}");
    }
}

#[test]
fn pointwise_effects_join_the_pass_before_them_or_the_tiles() {
    let grey = PostEffect::Grayscale { amount: 0.5 };
    let aces = tonemap_by(TonemapOperator::Aces, 2.0);
    let only = chain(&[grey.clone(), aces.clone()]);
    assert_eq!((only.in_tiles.len(), only.passes.len(), only.last_steps().len()), (2, 0, 0));

    let mixed = chain(&[grey.clone(), PostEffect::Fxaa, aces, grey, PostEffect::Sharpen { amount: 1.0 }]);
    assert_eq!(mixed.in_tiles, [Pointwise::Grayscale(0.5)]);
    assert_eq!(mixed.passes.len(), 2);
    let steps = [Pointwise::Tonemap { curve: Curve::Aces, exposure: 2.0 }, Pointwise::Grayscale(0.5)];
    assert_eq!(
        (&mixed.passes[0].effect, mixed.passes[0].then.as_slice()),
        (&Some(Neighbourhood::Fxaa(Fxaa)), &steps[..])
    );
    assert_eq!(mixed.last_steps(), []);
}

#[test]
fn a_chain_costs_its_planes_and_nothing_without_passes() {
    let blur = PostEffect::Blur { radius: 2.0 };
    let plane = 96 * 60 * 4;
    assert_eq!(PostChain::stride(80), 96);
    assert_eq!(chain(&[PostEffect::Grayscale { amount: 1.0 }]).frame_bytes(80, 60, true), 0);
    assert_eq!(chain(std::slice::from_ref(&blur)).frame_bytes(80, 60, false), 4 * plane);
    assert_eq!(chain(std::slice::from_ref(&blur)).frame_bytes(80, 60, true), 5 * plane);
    assert_eq!(chain(&[blur, PostEffect::Fxaa]).frame_bytes(80, 60, false), 5 * plane);
}

#[test]
fn rows_hold_whole_strips_and_columns_spread_over_a_cache() {
    for (width, stride) in [(1, 32), (32, 32), (33, 64), (512, 544), (800, 800), (16_384, 16_416)] {
        assert_eq!(PostChain::stride(width), stride);
    }
}

#[test]
fn a_gaussian_reaches_to_its_radius_and_sums_to_one() {
    for (radius, reach) in [(0.5, 1), (1.0, 1), (1.01, 2), (4.0, 4), (32.0, 32), (255.5, 256)] {
        let gaussian = Gaussian::new(radius).unwrap();
        assert_eq!(gaussian.weights.len(), reach);
        let weights: Vec<f64> = gaussian.weights.iter().map(|weight| f64::from(*weight)).collect();
        assert!(weights.is_sorted_by(|a, b| a > b));
        let own = 1.0 - 2.0 * weights.iter().sum::<f64>();
        // What a weight is to the pixel's own is exp(−k²/2σ²), and σ half the radius.
        let ratio = (-2.0 / (radius * radius)).exp();
        assert!((weights[0] / own / ratio - 1.0).abs() < 1e-5, "{radius}");
    }
}

#[test]
fn a_kernel_keeps_its_weights_and_no_zeros() {
    let rows = vec![vec![0.0, 0.0, 0.0], vec![-1.0, 0.0, 2.0], vec![0.0, 0.5, 0.0]];
    let kernel = Kernel::new(&rows);
    assert_eq!(kernel.reach, 1);
    let of_row = |row: usize, weights: &[(usize, f32)]| KernelRow { row, weights: weights.to_vec() };
    assert_eq!(kernel.rows, [of_row(1, &[(0, -1.0), (2, 2.0)]), of_row(2, &[(1, 0.5)])]);
}
