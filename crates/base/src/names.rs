//! Names of the variants of enumerations, each written once.

/// Lists the variants of an enumeration with their names: makes `ALL`, in this order, `name`, and `Display`, which writes the
/// name.
///
/// ```
/// #[derive(Clone, Copy, Debug, PartialEq, Eq)]
/// enum Side {
///     Left,
///     Right,
/// }
///
/// wildfire_base::names! { Side { Left: "left", Right: "right" } }
///
/// assert_eq!(Side::ALL, [Side::Left, Side::Right]);
/// assert_eq!(format!("{:>6}", Side::Left), "  left");
/// ```
#[macro_export]
macro_rules! names {
    ($Enumeration:ident { $($Variant:ident: $name:literal),+ $(,)? }) => {
        impl $Enumeration {
            /// All of them, in their order.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$Variant),+];

            /// Returns the name that people and files read.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$Variant => $name),+
                }
            }
        }

        impl std::fmt::Display for $Enumeration {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }
    };
}
